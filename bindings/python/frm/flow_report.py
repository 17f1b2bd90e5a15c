"""A flow as one page: python3 -m frm.flow_report DIR [-o report.html]

Reads what `frm flow --report DIR` leaves there, and needs numpy and matplotlib (apt install python3-matplotlib):

flow.json   what `frm flow --json` prints, and under "report" the case: mesh, notes, direction, speed (m/s), ...;
            "axes", the stream's frame as unit vectors of the mesh's (x along the stream); "lift_axis", where the
            force across the stream swings most; and "slices", what slices.f32 holds.
series.csv  what `frm flow -o` writes: a row a sample, SI units, the mesh's frame.
slices.f32  little-endian 32-bit floats. A slice is "rows" times "columns" speeds (shares of the stream's), row after
            row, and then as many pressure coefficients; it begins at value "offset". Values are NaN in the body.
            Value [row][column] is at "low" plus column times "spacing" (m) along x and row times "spacing" along y
            (where "normal" is 2) or z (where it is 1), in the stream's frame about the mesh's origin.
"""
from __future__ import annotations

import sys
from pathlib import Path

from .report import run_folder_program, write_whole


def write_report(folder, output=None) -> None:
    """Writes the page about the flow in `folder`; `output` appears whole or not at all."""
    from . import _flow, _flow_page
    folder = Path(folder)
    page = _flow_page.page(_flow.read(folder))
    write_whole(Path(output) if output else folder / "report.html", page)


def main(arguments: list[str] | None = None) -> int:
    return run_folder_program("flow", write_report, arguments)


if __name__ == "__main__":
    sys.exit(main())
