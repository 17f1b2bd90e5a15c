"""A bake as one page: python3 -m frm.bake_report DIR [-o report.html]

Reads what `frm bake --report DIR` leaves there, and needs numpy and matplotlib (apt install python3-matplotlib):

bake.json  what was asked for ("options"), the body, the map, its "errors" and their "budgets" (shares; null: not known,
           or not asked for), and "flows": a run of the solver each, with what `frm flow --json` says of it. SI units,
           the mesh's frame. "left_out" is the error of a flow's mean force as all others predict it, a share of the
           largest force; "lift_axis", where the force across the stream swings most; "axes", the stream's frame as
           unit vectors of the mesh's (x along the stream).
bake.f32   little-endian 32-bit floats, where an "offset" and a "shape" in bake.json say what is there: the array
           begins at that value, row after row.

           surface  "vertices" (m); "triangles" (three vertices each), in the order of their haptic regions;
                    "region_begin" (first triangle of each region, and the end); "sources" (place, m, and normal)
           means    direction and mean force on the whole body (N) at the base speed, as the map has them
           fluctuation_directions, fluctuations (samples of each direction one after another, N, of one period),
           fluctuation_faces (three neighbouring directions each)
           of each flow "images" (directions that it is known in by symmetry, its own first); "series" (force, N, and
           torque about the mesh's origin, N m, a row each "interval" seconds); "slice" (speed on a plane, shares of
           the stream's, NaN in the body: at "low" plus column times "spacing" along x and row times "spacing" along y,
           where "normal" is 2, or z, where it is 1, in the stream's frame about the mesh's origin, m)
"""
from __future__ import annotations

import sys
from pathlib import Path

from .report import run_folder_program, write_whole


def write_report(folder, output=None) -> None:
    """Writes the page about the bake in `folder`; `output` appears whole or not at all."""
    from . import _bake, _bake_page
    folder = Path(folder)
    page = _bake_page.page(_bake.read(folder))
    write_whole(Path(output) if output else folder / "report.html", page)


def main(arguments: list[str] | None = None) -> int:
    return run_folder_program("bake", write_report, arguments)


if __name__ == "__main__":
    sys.exit(main())
