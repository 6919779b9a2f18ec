"""The picture of docs/index.md: `.venv/bin/python docs/moving_modes.py` writes docs/moving_modes.png (some seconds).

The modes of eight and seven nodal diameters of the frustum in the ten lines beside it, drawn exaggerated.
"""

from pathlib import Path

import casingfem as cf
from casingfem.plot.body.shapes import frames, moving_picture
from contact.io.outfiles import write_atomic

HERE = Path(__file__).parent


def main() -> None:
    """Compute the modes and draw them."""
    casing = cf.Shell(
        chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25), thickness=3e-3,
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()},
        radius_defect=cf.FourierField.of({8: 0.002}),
    )  # fmt: skip
    path = HERE / "moving_modes.png"
    write_atomic(path, moving_picture(frames(cf.modes(casing, count=12), (0, 1), columns=2)))
    print(f"wrote {path}")


if __name__ == "__main__":
    main()
