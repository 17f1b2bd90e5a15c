"""frm bake: a real one, small; what it leaves when it fails."""
import os
import pty
import shutil
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
    assert str(path) in outcome.out and "3 flows" in outcome.out
    assert "cell updates" in outcome.err and "symmetry: 8 elements" in outcome.err


def test_same_bytes_with_two_threads(good, box, baked, tmp_path):
    outcome = good("bake", box, "-o", tmp_path / "b.frm", *SMALL, "--threads", 2, "--json")
    assert (tmp_path / "b.frm").read_bytes() == baked[0].read_bytes()
    # Six directions, of which symmetry leaves three; the means are stored for the 146 that a draft has.
    assert (outcome.json["flows"], outcome.json["directions"], outcome.json["sources"]) == (3, 146, 6)
    assert outcome.json["file_bytes"] == baked[0].stat().st_size


def test_info_verify_and_force_take_it(good, baked):
    info = good("info", baked[0], "--json").json
    assert (info["sources"], info["directions"], info["fluctuation_directions"]) == (6, 146, 6)
    assert info["provenance"]["mesh"] == "box.glb" and len(info["provenance"]["directions"]) == 3
    assert info["provenance"]["symmetry"] == {"kind": "finite", "isometries": 8}
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


def test_an_older_file_stays_when_it_fails(frm, map_path, tmp_path):
    older = map_path.read_bytes()
    (tmp_path / "b.frm").write_bytes(older)
    mesh = tmp_path / "mesh.glb"
    mesh.write_bytes(cube_without_a_side())
    assert frm("bake", mesh, "-o", tmp_path / "b.frm", *SMALL).status == 1
    assert (tmp_path / "b.frm").read_bytes() == older
    assert names(tmp_path) == ["b.frm", "mesh.glb", "mesh.problem.glb"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_flow_leaves_nothing(box, tmp_path, number):
    (tmp_path / "out").write_text("older")
    process = subprocess.Popen([PROGRAM, "flow", "--direction", "1,0,0", "--speed", "1", "--start-up", "1000", str(box),
                                "-o", str(tmp_path / "out"), "--threads", "1"], text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    # The first progress line comes after two seconds: the flow is still starting.
    for line in process.stderr:
        if "%, " in line:
            break
    process.send_signal(number)
    out, err = process.communicate(timeout=100)
    assert process.returncode == 1 and out == "" and "interrupted" in err
    assert names(tmp_path) == ["out"] and (tmp_path / "out").read_text() == "older"


def test_without_out_it_is_the_meshs_name_here(good, refused, box, baked, tmp_path):
    (tmp_path / "meshes").mkdir()
    (tmp_path / "here").mkdir()
    shutil.copy(box, tmp_path / "meshes" / "a box.glb")
    good("bake", "../meshes/a box.glb", *SMALL, cwd=tmp_path / "here")
    assert names(tmp_path / "meshes") == ["a box.glb"] and names(tmp_path / "here") == ["a box.frm"]
    # It was not named: hours may be in it.
    before = (tmp_path / "here" / "a box.frm").read_bytes()
    refused(1, "a box.frm|already there|--force|-o", "bake", "../meshes/a box.glb", *SMALL, cwd=tmp_path / "here")
    assert (tmp_path / "here" / "a box.frm").read_bytes() == before
    good("bake", "../meshes/a box.glb", *SMALL, "--speed", "1", "--force", cwd=tmp_path / "here")
    assert (tmp_path / "here" / "a box.frm").read_bytes() != before


def test_what_is_not_a_map_is_not_replaced(good, refused, box, map_path, tmp_path):
    out = tmp_path / "thesis.txt"
    out.write_text("years of work")
    refused(1, "thesis.txt|not a map|--force", "bake", box, "-o", out, *SMALL)
    assert out.read_text() == "years of work" and names(tmp_path) == ["thesis.txt"]
    good("bake", box, "-o", out, *SMALL, "--force")
    older = tmp_path / "older.frm"
    shutil.copy(map_path, older)
    good("bake", box, "-o", older, *SMALL)  # a map that was named is baked anew
    assert older.read_bytes() == out.read_bytes()


def sized(extent):
    return glb(vertices=[tuple(c * extent / 0.1 for c in v) for v in CUBE])


@pytest.mark.parametrize("extent, words", [
    (1500, "1.5e+03 m|millimetres|--scale 0.001|1.5 m|--yes"), (30, "30 m|in inches, add --scale 0.0254 (0.762 m), in centimetres --scale 0.01 (0.3 m), in millimetres|--yes"),
    (0.0015, "0.0015 m|converted twice|--scale 1000|--yes")])
@pytest.mark.parametrize("command", [["bake"], ["bake", "plan"]], ids=["bake", "plan"])
def test_a_size_that_is_not_plausible_needs_a_word(refused, tmp_path, command, extent, words):
    mesh = tmp_path / "mesh.glb"
    mesh.write_bytes(sized(extent))
    refused(1, "mesh.glb|" + words, *command, mesh, "-o", tmp_path / "out", *SMALL)
    assert names(tmp_path) == ["mesh.glb"]


def test_a_scaled_mesh_is_the_mesh_in_metres(good, tmp_path):
    (tmp_path / "mm.glb").write_bytes(sized(100))
    (tmp_path / "m.glb").write_bytes(sized(0.1))
    good("bake", tmp_path / "mm.glb", "--scale", "0.001", "-o", tmp_path / "mm.frm", *SMALL)
    good("bake", tmp_path / "m.glb", "-o", tmp_path / "m.frm", *SMALL)
    one, two = (good("info", tmp_path / name, "--json").json for name in ("mm.frm", "m.frm"))
    assert one["provenance"]["scale"] == 0.001 and "scale" not in two["provenance"]
    assert one["volume"] == pytest.approx(two["volume"], rel=1e-5) and one["volume"] == pytest.approx(1e-3, rel=1e-5)
    assert one["reynolds"] == pytest.approx(two["reynolds"], rel=1e-5)


def test_yes_takes_the_size_as_it_is(good, tmp_path):
    (tmp_path / "ship.glb").write_bytes(sized(30))
    good("bake", tmp_path / "ship.glb", "--yes", "-o", tmp_path / "ship.frm", *SMALL)
    assert good("info", tmp_path / "ship.frm", "--json").json["volume"] == pytest.approx(27000, rel=1e-5)


@pytest.mark.parametrize("answers, volume, words", [
    ("1\n", 1, "1  centimetres: 1 m"), ("2\n", 2.54 ** 3, "2  inches: 2.54 m"), ("4\n", 1e6, "4  metres: 100 m is right"),
    ("5\n", None, "--scale F"), ("y\n", None, "[1-4]"), ("\x04", None, "--scale F")],
    ids=["likely", "another", "as it is", "none", "word", "end"])
def test_on_a_terminal_it_asks(good, tmp_path, answers, volume, words):
    (tmp_path / "mesh.glb").write_bytes(sized(100))
    ours, theirs = pty.openpty()
    process = subprocess.Popen([PROGRAM, "bake", str(tmp_path / "mesh.glb"), "-o", str(tmp_path / "out.frm"), *SMALL],
                               stdin=theirs, stdout=subprocess.PIPE, stderr=theirs)
    os.close(theirs)
    os.write(ours, answers.encode())
    said = b""
    while True:
        try:
            chunk = os.read(ours, 65536)
        except OSError:  # how Linux says that the other side is closed
            break
        if not chunk:
            break
        said += chunk
    assert process.wait(timeout=100) == (1 if volume is None else 0)
    assert words in said.decode()
    if volume:
        assert good("info", tmp_path / "out.frm", "--json").json["volume"] == pytest.approx(volume, rel=1e-5)
    else:
        assert names(tmp_path) == ["mesh.glb"]
