"""frm bake: a real one, small; what it leaves when it fails."""
import signal
import subprocess
import time

import pytest

from conftest import PROGRAM, names
from gltf import CUBE, SIDES, glb

SMALL = ["--directions", "6", "--sources", "6", "--resolution", "4", "--quality", "draft"]


@pytest.fixture(scope="module")
def baked(good, box, tmp_path_factory):
    """(path, outcome) of a bake on one thread into a folder with a space in its name."""
    path = tmp_path_factory.mktemp("with space") / "a box.frm"
    return path, good("bake", box, "-o", path, *SMALL, "--threads", 1)


def test_it_leaves_one_file_and_says_what(baked):
    path, outcome = baked
    assert names(path.parent) == ["a box.frm"]
    assert str(path) in outcome.out and "6 directions" in outcome.out
    assert "cell updates" in outcome.err


def test_same_bytes_with_two_threads(good, box, baked, tmp_path):
    outcome = good("bake", box, "-o", tmp_path / "b.frm", *SMALL, "--threads", 2, "--json")
    assert (tmp_path / "b.frm").read_bytes() == baked[0].read_bytes()
    assert outcome.json["directions"] == 6 and outcome.json["sources"] == 6
    assert outcome.json["file_bytes"] == baked[0].stat().st_size


def test_info_verify_and_force_take_it(good, baked):
    info = good("info", baked[0], "--json").json
    assert (info["sources"], info["directions"]) == (6, 6)
    assert info["provenance"]["mesh"] == "box.glb" and len(info["provenance"]["directions"]) == 6
    assert "box.glb" in good("info", baked[0]).out
    assert "sound" in good("verify", baked[0]).out
    force = good("force", baked[0], "--velocity", "-0.5,0,0", "--json").json
    assert force["force_mean"][0] > 0


def test_a_refused_number_of_directions(refused, box, tmp_path):
    refused(1, "--directions 7|6, 18, 38", "bake", box, "-o", tmp_path / "b.frm", "--directions", "7")
    assert names(tmp_path) == []


def cube_without_a_side():
    return glb(triangles=SIDES[:-1])


def flat_sheet():
    return glb(vertices=CUBE[:4], triangles=[(0, 1, 2), (1, 3, 2), (0, 2, 1), (1, 2, 3)])


def draco():
    return glb(extensionsUsed=["KHR_draco_mesh_compression"], extensionsRequired=["KHR_draco_mesh_compression"])


@pytest.mark.parametrize("content, words, shown", [
    (cube_without_a_side(), "open|edge|mesh.problem.glb", True), (flat_sheet(), "thick|mesh.problem.glb", True),
    (draco(), "Draco|without compression", False), (b"solid not a gltf\n" * 4, "mesh.glb", False),
    (b"", "mesh.glb", False), (glb()[:200], "cut off|again", False),
    (glb(vertices=[tuple(1e12 * c for c in v) for v in CUBE]), "mesh.glb", False),
], ids=["open", "flat", "draco", "text", "empty", "truncated", "huge"])
@pytest.mark.parametrize("command", ["bake", "flow"])
def test_refused_meshes(refused, tmp_path, command, content, words, shown):
    mesh = tmp_path / "mesh.glb"
    mesh.write_bytes(content)
    options = SMALL if command == "bake" else ["--direction", "1,0,0", "--speed", "1"]
    refused(1, "mesh.glb|" + words, command, mesh, "-o", tmp_path / "out", *options)
    assert names(tmp_path) == ["mesh.glb"] + ["mesh.problem.glb"] * shown


def test_a_folder_that_is_not_there_fails_before_the_work(refused, box, tmp_path):
    begin = time.monotonic()
    refused(1, "nowhere/b.frm", "bake", box, "-o", tmp_path / "nowhere" / "b.frm", "--quality", "high")
    assert time.monotonic() - begin < 5


@pytest.mark.parametrize("out", ["/dev/null", "/dev/stdout", "/"])
def test_devices_and_folders_are_not_replaced(refused, box, out):
    refused(1, out, "bake", box, "-o", out, *SMALL)


def test_the_mesh_is_not_overwritten(refused, tmp_path):
    mesh = tmp_path / "mesh.glb"
    mesh.write_bytes(glb())
    refused(1, "mesh.glb|another file", "bake", mesh, "-o", mesh, *SMALL)
    refused(1, "mesh.glb|another file", "flow", mesh, "-o", mesh, "--direction", "1,0,0", "--speed", "1")
    assert mesh.read_bytes() == glb()


def test_an_older_file_stays_when_it_fails(frm, tmp_path):
    (tmp_path / "b.frm").write_text("older")
    mesh = tmp_path / "mesh.glb"
    mesh.write_bytes(cube_without_a_side())
    assert frm("bake", mesh, "-o", tmp_path / "b.frm", *SMALL).status == 1
    assert (tmp_path / "b.frm").read_text() == "older"
    assert names(tmp_path) == ["b.frm", "mesh.glb", "mesh.problem.glb"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("command", [["bake"], ["flow", "--direction", "1,0,0", "--speed", "1", "--start-up", "1000"]],
                         ids=["bake", "flow"])
def test_an_interrupt_leaves_nothing(box, tmp_path, command, number):
    (tmp_path / "out").write_text("older")
    process = subprocess.Popen([PROGRAM, *command, str(box), "-o", str(tmp_path / "out"), "--threads", "1"], text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    # The first progress line comes after two seconds: the solver runs then (flow: it is still starting).
    for line in process.stderr:
        if "%, " in line:
            break
    process.send_signal(number)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 1 and out == "" and "interrupted" in err
    assert names(tmp_path) == ["out"] and (tmp_path / "out").read_text() == "older"
