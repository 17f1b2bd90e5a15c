"""What the tests of the bench share: the program, and one quick run of each scene."""
from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("FRM_PROGRAM", str(ROOT / "build" / "release" / "frm"))
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "scripts" / "lib")]


@pytest.fixture(scope="session")
def frm():
    """frm(*arguments) runs the program."""
    if not Path(PROGRAM).exists():
        pytest.skip(f"{PROGRAM} is not there; FRM_PROGRAM names the program")
    return lambda *arguments: subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=500)


@pytest.fixture(scope="session")
def measured(frm):
    """measured(scene) is the whole answer of a quick run of it; each scene runs once."""
    kept = {}

    def run(scene, *more):
        if (scene, *more) not in kept:
            done = frm("bench", "frontier", "--quick", "--repeats", 2, "--scene", scene, "--json", *more)
            assert done.returncode == 0, done.stderr
            kept[(scene, *more)] = json.loads(done.stdout)
        return kept[(scene, *more)]
    return run


@pytest.fixture(scope="session")
def table(measured):
    def of(scene, *more):
        answer = measured(scene, *more)
        assert len(answer["scenes"]) == 1
        return answer["scenes"][0]
    return of


@pytest.fixture(scope="session")
def knob(table):
    """knob(scene, name): the rows of one knob, in the order of the bench: from coarse to fine."""
    def of(scene, name):
        rows = [row for row in table(scene)["rows"] if row["knob"] == name]
        assert rows, f"{scene} has no knob {name}"
        return rows
    return of


def pytest_configure(config):
    config.addinivalue_line("markers", "full: takes longer (ctest -L full)")
