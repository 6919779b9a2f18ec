"""Sketches of the pages: `.venv/bin/python -m docs.sketches` writes docs/theory/*.svg and docs/data_flow.svg."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent / "theory"
INK, BLUE, RED, GREEN, GREY = "#333", "#0a5fa8", "#c0392b", "#2a8a5f", "#999"
Points = Sequence[tuple[float, float]] | np.ndarray


def line(points: Points, colour: str = INK, wide: float = 2.0, more: str = "") -> str:
    """A line through points (n, 2)."""
    path = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
    return f'<path d="M{path}" stroke="{colour}" stroke-width="{wide}" {more}/>'


def arrow(a: tuple[float, float], b: tuple[float, float], colour: str = INK, wide: float = 2.0) -> str:
    """An arrow from a to b."""
    along = np.subtract(b, a) / np.hypot(*np.subtract(b, a))
    across = np.array([-along[1], along[0]])
    head = [np.array(b), b - 9.0 * along + 4.0 * across, b - 9.0 * along - 4.0 * across]
    tip = " ".join(f"{x:.1f},{y:.1f}" for x, y in head)
    end = tuple(np.subtract(b, 6.0 * along))
    return line([a, end], colour, wide) + f'<polygon points="{tip}" fill="{colour}" stroke="none"/>'


def word(x: float, y: float, text: str, colour: str = INK, anchor: str = "start") -> str:
    """A text whose line begins, ends or has its middle at x."""
    return f'<text x="{x:g}" y="{y:g}" fill="{colour}" text-anchor="{anchor}" stroke="none">{text}</text>'


def dot(x: float, y: float, colour: str = INK, size: float = 4.0) -> str:
    """A filled disc."""
    return f'<circle cx="{x:g}" cy="{y:g}" r="{size:g}" fill="{colour}" stroke="none"/>'


def ring(x: float, y: float, radius: float, wave: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """A circle whose radius varies over the angle."""
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    size = radius + wave(angle)
    return np.stack([x + size * np.cos(angle), y - size * np.sin(angle)], axis=1)


def spring(x: float, top: float, bottom: float) -> str:
    """A spring between two heights."""
    y = np.linspace(top, bottom, 12)
    side = np.array([0, 0, *([7, -7] * 4), 0, 0], dtype=float)
    return line(np.stack([x + side, y], axis=1), INK, 1.5)


def shell() -> list[str]:
    """A wall: mid-surface, frame, thickness, and the normal before and after it deforms."""
    turn = np.radians(np.linspace(155.0, 25.0, 60))

    def arc(radius: float) -> np.ndarray:
        return np.stack([260.0 + radius * np.cos(turn), 300.0 - radius * np.sin(turn)], axis=1)

    wall = np.concatenate([arc(248.0), arc(212.0)[::-1]])
    shape = " ".join(f"{x:.1f},{y:.1f}" for x, y in wall)
    return [
        f'<polygon points="{shape}" fill="#dbe9f5" stroke="{GREY}"/>',
        line(arc(230.0), BLUE, 2.0, 'stroke-dasharray="7 4"'),
        arrow((260, 70), (330, 70), BLUE),
        arrow((260, 70), (260, 12), BLUE),
        dot(260, 70, BLUE),
        word(334, 66, "e₁", BLUE),
        word(268, 20, "a₃, z", BLUE),
        line([(127, 97), (145, 129)], GREY, 3.0),
        line([(121, 112), (151, 116)], RED, 3.0),
        word(52, 84, "normal"),
        word(24, 116, "turned by w", RED),
        arrow((418, 88), (409, 99)),
        arrow((375, 142), (384, 131)),
        word(362, 152, "t"),
        word(204, 122, "mid-surface X(ξ₁, ξ₂)", BLUE),
        word(260, 168, "displacement u, rotation w", INK, "middle"),
    ]


def reduction() -> list[str]:
    """A body with many unknowns; the same body as some modes and a residual spring where the contact acts."""
    x = np.linspace(0.0, 1.0, 9)
    grid = [line([(40 + 150 * a, 40 + 8 * a), (40 + 150 * a, 100 - 8 * a)], GREY, 1.0) for a in x]
    grid += [line([(40, 40 + 60 * b), (190, 48 + 44 * b)], GREY, 1.0) for b in np.linspace(0.0, 1.0, 5)]
    modes = [
        part
        for k, place in enumerate((300, 345, 390))
        for part in (
            spring(place, 30, 70),
            f'<rect x="{place - 13}" y="70" width="26" height="20" fill="#dbe9f5"/>',
            line([(place, 90), (place, 110)], INK, 1.5),
            word(place, 85, f"q{'₁₂₃'[k]}", INK, "middle"),
        )
    ]
    return [
        line([(40, 30), (40, 110)], INK, 4.0),
        *grid,
        dot(190, 70, RED),
        arrow((190, 130), (190, 78), RED),
        word(198, 126, "λ", RED),
        word(198, 64, "u", RED),
        word(60, 160, "K, M: 30,000 unknowns"),
        arrow((225, 70), (262, 70), BLUE),
        line([(280, 30), (410, 30)], INK, 4.0),
        *modes,
        line([(300, 110), (390, 110)], INK, 3.0),
        spring(345, 110, 148),
        word(360, 134, "S", BLUE),
        dot(345, 148, RED),
        arrow((345, 192), (345, 156), RED),
        word(353, 186, "λ", RED),
        word(330, 160, "u", RED, "end"),
        word(404, 74, "60 modes"),
        word(404, 134, "static compliance", BLUE),
        word(404, 152, "of all others", BLUE),
    ]


def pairs() -> list[str]:
    """The two members of a pair on a ring with a defect of twice their nodal diameters, and their frequencies."""
    parts = [line(ring(110, 105, 62, lambda a: 0.0 * a), GREY, 1.5)]
    thick = ring(110, 105, 62, lambda a: 6.0 * np.cos(4.0 * a))
    low, high = (ring(110, 105, 62, lambda a, s=s: 20.0 * np.cos(2.0 * a - s)) for s in (0.0, np.pi / 2.0))
    parts += [line(low, BLUE), line(high, RED, 2.0, 'stroke-dasharray="6 4"')]
    parts += [
        line(thick + np.array([165.0, 0.0]), INK, 5.0, 'opacity="0.35"'),
        line(ring(275, 105, 62, lambda a: 0.0 * a), GREY, 1.5),
    ]
    return [
        *parts,
        word(110, 110, "n = 2", INK, "middle"),
        word(275, 110, "p = 4", INK, "middle"),
        word(110, 205, "two members", INK, "middle"),
        word(275, 205, "defect", INK, "middle"),
        arrow((385, 180), (385, 25), INK, 1.5),
        word(393, 32, "f"),
        arrow((385, 180), (520, 180), INK, 1.5),
        word(520, 198, "size of the defect", INK, "end"),
        line([(385, 105), (505, 60)], RED, 2.0, 'stroke-dasharray="6 4"'),
        line([(385, 105), (505, 150)], BLUE),
        arrow((495, 105), (495, 68), INK, 1.2),
        arrow((495, 105), (495, 142), INK, 1.2),
        word(489, 110, "split", INK, "end"),
    ]


def contact() -> list[str]:
    """The law of unilateral contact, and how a bouncing point follows it."""
    time = np.linspace(0.0, 1.0, 121)
    height = np.where(
        time < 0.35, 80 * (1 - (time / 0.35) ** 2), np.where(time < 0.6, 0.0, 55 * np.sin(np.pi * (time - 0.6) / 0.75))
    )
    force = np.where((time > 0.35) & (time < 0.6), 45 * np.sin(np.pi * (time - 0.35) / 0.25), 0.0)
    return [
        arrow((40, 160), (190, 160), INK, 1.5),
        arrow((60, 180), (60, 30), INK, 1.5),
        word(186, 178, "gap g"),
        word(68, 38, "force F"),
        line([(60, 45), (60, 160), (180, 160)], BLUE, 5.0),
        word(78, 82, "closed: g = 0", BLUE),
        word(96, 150, "open: F = 0", BLUE),
        arrow((250, 110), (505, 110), INK, 1.5),
        line(np.stack([255 + 240 * time, 110 - height], axis=1), BLUE, 2.5),
        arrow((250, 190), (505, 190), INK, 1.5),
        line(np.stack([255 + 240 * time, 190 - force], axis=1), RED, 2.5),
        word(262, 24, "g(t)", BLUE),
        word(262, 180, "F(t)", RED),
        word(505, 205, "time", INK, "end"),
    ]


def friction() -> list[str]:
    """Coulomb's cone, and a blade that leans into the motion of the rim."""
    return [
        '<polygon points="110,170 40,40 180,40" fill="#dbe9f5" stroke="none"/>',
        line([(40, 40), (110, 170), (180, 40)], BLUE, 3.0),
        arrow((110, 180), (110, 22), INK, 1.5),
        arrow((25, 170), (205, 170), INK, 1.5),
        word(118, 30, "F_N"),
        word(196, 188, "F_T"),
        word(110, 66, "sticks", BLUE, "middle"),
        word(172, 100, "slips: F_T = μ F_N", BLUE),
        line(np.stack([np.linspace(310, 500, 40), 60 - 22 * np.sin(np.linspace(0.0, np.pi, 40))], axis=1), INK, 4.0),
        arrow((370, 28), (322, 40), BLUE),
        word(330, 20, "rim moves", BLUE),
        line([(345, 185), (402, 46)], INK, 7.0),
        line([(345, 185), (345, 60)], GREY, 1.2, 'stroke-dasharray="5 4"'),
        word(353, 122, "a"),
        arrow((402, 44), (402, 102), RED),
        word(409, 100, "F_N", RED),
        arrow((402, 44), (352, 52), RED),
        word(322, 76, "μ F_N", RED),
        word(310, 207, "digs in where μ &gt; tan a"),
    ]


def cycles() -> list[str]:
    """A motion that closes on itself, and where its multipliers leave the unit circle."""
    angle = np.linspace(0.0, 2.0 * np.pi, 160)
    orbit = np.stack([110 + 75 * np.cos(angle), 100 - 48 * np.sin(angle) - 14 * np.sin(2.0 * angle)], axis=1)
    near = np.stack(
        [110 + (75 + 3.2 * angle) * np.cos(angle), 100 - (48 + 2.8 * angle) * np.sin(angle) - 14 * np.sin(2.0 * angle)],
        axis=1,
    )
    return [
        line(orbit, BLUE, 3.0),
        line(near, RED, 1.5, 'stroke-dasharray="5 4"'),
        dot(185, 100, BLUE),
        dot(*near[-1], RED),
        word(110, 105, "x(T) = x₀", BLUE, "middle"),
        word(30, 190, "a neighbour moves away: |multiplier| &gt; 1", RED),
        f'<circle cx="355" cy="100" r="62" stroke="{GREY}"/>',
        arrow((265, 100), (465, 100), GREY, 1.0),
        arrow((355, 182), (355, 16), GREY, 1.0),
        arrow((380, 100), (435, 100), RED),
        word(439, 92, "+1: fold", RED),
        arrow((327, 100), (277, 100), RED),
        word(265, 92, "−1: flip", RED, "end"),
        arrow((380, 75), (408, 47), RED),
        arrow((380, 125), (408, 153), RED),
        word(415, 40, "pair:", RED),
        word(415, 56, "quasi-periodic", RED),
    ]


def updating() -> list[str]:
    """Measured rows against modes, and the steps of a fit in a narrow valley of its sum of squares."""
    angle = np.linspace(0.0, 2.0 * np.pi, 120)
    turn = np.radians(28.0)

    def ellipse(size: float) -> np.ndarray:
        a, b = 118.0 * size * np.cos(angle), 24.0 * size * np.sin(angle)
        return np.stack([390 + a * np.cos(turn) - b * np.sin(turn), 105 - a * np.sin(turn) - b * np.cos(turn)], axis=1)

    steps = [(292, 40), (308, 128), (348, 128), (376, 114), (390, 105)]
    measured, computed = (40, 66, 96, 130, 166), (48, 58, 108, 124, 178)
    rows = [
        part
        for a, b in zip(measured, computed, strict=True)
        for part in (
            line([(70, a), (110, a)], INK, 3.0),
            line([(110, a), (150, b)], GREY, 1.2),
            line([(150, b), (190, b)], BLUE, 3.0),
        )
    ]
    return [
        *rows,
        word(90, 200, "measured", INK, "middle"),
        word(170, 200, "computed", BLUE, "middle"),
        arrow((50, 185), (50, 24), INK, 1.5),
        word(40, 36, "f", INK, "end"),
        *(line(ellipse(size), GREY, 1.2) for size in (0.35, 0.65, 1.0)),
        line(steps, RED, 2.0),
        *(dot(x, y, RED, 3.5) for x, y in steps),
        word(286, 30, "start", RED),
        arrow((270, 190), (510, 190), INK, 1.5),
        arrow((270, 190), (270, 20), INK, 1.5),
        word(505, 207, "x₁", INK, "end"),
        word(276, 16, "x₂"),
        word(420, 176, "lines of equal χ²", "#666", "middle"),
    ]


def data_flow() -> list[str]:
    """Files on the left, objects in boxes, the functions that make them beside the arrows, results on the right."""

    def box(x: float, y: float, name: str, fill: str, wide: float = 114.0) -> str:
        corner = f'x="{x - wide / 2.0:g}" y="{y - 14.0:g}"'
        frame = f'<rect {corner} width="{wide:g}" height="28" rx="4" fill="{fill}" stroke="{GREY}"/>'
        return frame + word(x, y + 5, name, INK, "middle")

    made, computed = "#dbe9f5", "#f3e2cf"
    return [
        word(8, 29, "survey, drawing"),
        word(8, 84, "mesh, matrices"),
        word(8, 139, "records, FRFs"),
        word(8, 194, "scene.toml"),
        *(arrow((120, y), (150, y), GREY) for y in (24, 79, 134)),
        arrow((90, 189), (336, 189), GREY),
        box(210, 24, "Shell", made),
        box(210, 79, "Solid, MeshShell", made, 122.0),
        box(210, 134, "FrequencyTable", made, 118.0),
        arrow((210, 119), (210, 96), BLUE),
        word(220, 112, "update", BLUE),
        arrow((268, 24), (344, 70), BLUE),
        arrow((272, 79), (344, 79), BLUE),
        word(312, 38, "reduce", BLUE),
        box(390, 79, "Basis (npz)", made, 88.0),
        arrow((390, 94), (390, 172), GREY),
        box(375, 189, "Scene", computed, 74.0),
        arrow((413, 189), (456, 189), RED),
        word(434, 180, "run", RED, "middle"),
        box(495, 189, "Result", computed, 74.0),
        arrow((495, 174), (495, 134), GREY),
        word(495, 94, "tables,", INK, "middle"),
        word(495, 110, "pictures,", INK, "middle"),
        word(495, 126, "pages", INK, "middle"),
    ]


SKETCHES = {one.__name__: one for one in (shell, reduction, pairs, contact, friction, cycles, updating)}
PAGES = {"data_flow": data_flow}  # beside docs/theory


def main() -> None:
    """Write every sketch."""
    files = {HERE / f"{name}.svg": draw for name, draw in SKETCHES.items()}
    files |= {HERE.parent / f"{name}.svg": draw for name, draw in PAGES.items()}
    for file, draw in files.items():
        head = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 540 215" font-family="sans-serif" font-size="14"'
        body = "\n".join(['<rect width="540" height="215" fill="#fff" stroke="none"/>', *draw()])
        text = f'{head} fill="none" stroke="{INK}">\n{body}\n</svg>\n'
        file.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
