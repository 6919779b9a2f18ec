"""Names of the channels of a rim at contacts."""


def rim_channels(n_max: int, directions: int = 2, lines: int = 1) -> tuple[str, ...]:
    """Channel names of a rim, direction-major: cos0, cos1 .. cosN, sin1 .. sinN, radial, tangential (and axial).

    Several rim lines follow each other, each with its number before the name.

    >>> rim_channels(1)[:3], rim_channels(1, 3, lines=2)[-1]
    (('radial.cos0', 'radial.cos1', 'radial.sin1'), 'line1.axial.sin1')
    """
    waves = [f"cos{n}" for n in range(n_max + 1)] + [f"sin{n}" for n in range(1, n_max + 1)]
    one = [f"{direction}.{wave}" for direction in ("radial", "tangential", "axial")[:directions] for wave in waves]
    return tuple(one) if lines == 1 else tuple(f"line{k}.{name}" for k in range(lines) for name in one)
