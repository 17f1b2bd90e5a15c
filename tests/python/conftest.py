"""What the tests share: the binding on the path, the header, a map, and small recordings."""
from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bindings" / "python"))


@pytest.fixture(scope="session")
def library():
    """The real library; FRM_LIBRARY names it, or it is in the build tree."""
    import frm
    try:
        return frm.library()
    except frm.LibraryError as error:
        if os.environ.get("FRM_LIBRARY"):
            raise
        pytest.skip(str(error))


@pytest.fixture
def context(library):
    import frm
    with frm.Context() as context:
        yield context


@pytest.fixture(scope="session")
def map_path():
    """A baked map."""
    path = os.environ.get("FRM_TEST_MAP")
    if not path:
        pytest.skip("FRM_TEST_MAP is not set: it names a baked .frm map")
    return path


def stroke(map, tick: int, ticks: int, dt: float):
    """Pose and twist of a body that goes down to half of its height and then across the water."""
    info = map.info()
    size = max(high - low for low, high in zip(info.bounds_low, info.bounds_high))
    speed = 2.0 * size / (ticks * dt)
    x = speed * dt * tick - size
    return ((x, 0.0, 0.1 * size), (0.0, 0.0, 0.0, 1.0)), ((speed, 0.0, 0.0), (0.0, 0.0, 0.0))


@pytest.fixture
def record(map_path, tmp_path):
    """record(ticks) makes a recording of a stroke and gives (path, forces of every tick)."""
    import frm

    def make(ticks: int = 150, dt: float = 0.002, name: str = "stroke.frmrec"):
        path = tmp_path / name
        totals = []
        with frm.Context() as context:
            map = frm.Map(context, map_path)
            world = frm.World(context)
            recorder = frm.Recorder(world, path, hash_interval=20)
            frm.Water(world, nx=64, ny=48, border_cells=2, cell=0.025)
            body = frm.Body(world, map, mass=0.5)
            for tick in range(ticks):
                body.set_motion(*stroke(map, tick, ticks, dt))
                world.tick(dt)
                totals.append(tuple(body.forces().total.force))
            recorder.close()
        return path, totals
    return make
