"""What the tests share: the program, meshes, a scene, and what every failure must look like."""
from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MESHES = ROOT / "samples" / "meshes"
# A shell without job control starts what runs in the background deaf to Ctrl-C, and so would be all that is started here.
signal.signal(signal.SIGINT, signal.default_int_handler)
PROGRAM = os.environ.get("FRM_PROGRAM", str(ROOT / "build" / "release" / "frm"))


class Outcome:
    def __init__(self, done):
        self.status, self.out, self.err = done.returncode, done.stdout, done.stderr

    @property
    def json(self):
        return json.loads(self.out)


@pytest.fixture(scope="session")
def frm():
    """frm(*arguments, cwd=None) runs the program."""
    if not Path(PROGRAM).exists():
        pytest.skip(f"{PROGRAM} is not there; FRM_PROGRAM names the program")

    def run(*arguments, cwd=None, timeout=200, **others):
        return Outcome(subprocess.run([PROGRAM, *map(str, arguments)], cwd=cwd, timeout=timeout, text=True,
                                      errors="replace", capture_output=True, **others))
    return run


@pytest.fixture(scope="session")
def good(frm):
    """As frm, for what must succeed."""
    def run(*arguments, **others):
        outcome = frm(*arguments, **others)
        assert outcome.status == 0, outcome.err
        return outcome
    return run


@pytest.fixture(scope="session")
def refused(frm):
    """refused(status, words, *arguments): fails with one line on stderr that has all the words, and no more."""
    def run(status, words, *arguments, **others):
        outcome = frm(*arguments, **others)
        assert outcome.status == status, (outcome.out, outcome.err)
        assert outcome.out == ""
        lines = [line for line in outcome.err.splitlines() if not line.startswith("note: ")]
        assert len(lines) == 1 and lines[0].startswith("frm"), outcome.err
        for word in words.split("|"):
            assert word in lines[0]
        return lines[0]
    return run


@pytest.fixture(scope="session")
def map_path():
    path = os.environ.get("FRM_TEST_MAP")
    if not path:
        pytest.skip("FRM_TEST_MAP is not set: it names a baked .frm map")
    return Path(path)


@pytest.fixture(scope="session")
def box():
    return MESHES / "box.glb"


@pytest.fixture
def scene(tmp_path, map_path):
    """scene(**changes) writes a small scene, with the keys changed or (None) taken out, and gives its path."""
    shutil.copy(map_path, tmp_path / "box.frm")

    def write(name="scene.json", body=None, **changes):
        j = {"title": "Small", "dt": 0.002, "seconds": 0.3,
             "water": {"nx": 48, "ny": 48, "cell": 0.025, "border_cells": 8},
             "maps": {"box": "box.frm"},
             "bodies": [{"map": "box", "mass": 1.5,
                         "motion": {"type": "steady", "position": [-0.1, 0, 0.05], "velocity": [0.4, 0, 0],
                                    "spin": [0, 0, 20]}}]}
        j.update(changes)
        if body:
            j["bodies"][0].update(body)
        path = tmp_path / name
        path.write_text(json.dumps({key: value for key, value in j.items() if value is not None}))
        return path
    return write


def names(folder):
    return sorted(path.name for path in Path(folder).iterdir())
