"""samples/read_map.py, which knows docs/format.md alone, reads what the library reads."""
from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

import frm


def resistance(context, path, velocity):
    """Of the paper's method, at map time 0 nearly: the body moves against the water."""
    world = frm.World(context, model=frm.MODEL_PAPER, surface=frm.SURFACE_NONE)
    body = frm.Body(world, frm.Map(context, path))
    body.set_motion(((0, 0, 0), (0, 0, 0, 1)), (tuple(-v for v in velocity), (0, 0, 0)))
    world.tick(1e-6)
    forces = body.forces()
    return [p + f for p, f in zip(forces.pressure.force, forces.friction.force)]


@pytest.mark.parametrize("which", ["test_map.frm", "full_map.frm", "v1.frm"])
def test_the_reader_of_the_format_agrees(context, map_path, which):
    path = ROOT / "tests" / "data" / which if which == "v1.frm" else Path(map_path).parent / which
    for velocity in ((0.3, -0.2, 0.45), (-0.5, 0.0, 0.0)):
        done = subprocess.run([sys.executable, str(ROOT / "samples" / "read_map.py"), str(path),
                               ",".join(map(str, velocity))], capture_output=True, text=True, check=True)
        found = [float(word) for word in done.stdout.splitlines()[-1].split(":")[1].rstrip("N \n").split(",")]
        expected = resistance(context, path, velocity)
        size = sum(v * v for v in expected) ** 0.5
        assert found == pytest.approx(expected, rel=1e-4, abs=1e-4 * size)
