"""What frm bake is asked for beyond one speed and a box: speeds, turns, symmetry, added mass, small harmonics."""
import math

import pytest

from conftest import MESHES, names
from gltf import glb

SMALL = ["--directions", "6", "--sources", "6", "--resolution", "4", "--quality", "draft"]


@pytest.fixture(scope="module")
def bake(good, box, tmp_path_factory):
    """bake(*options, mesh=box) gives (map's path, what bake said as JSON), each set of options once."""
    made = {}

    def run(*options, mesh=box):
        key = (str(mesh), *options)
        if key not in made:
            out = tmp_path_factory.mktemp("bake") / "map.frm"
            made[key] = out, good("bake", mesh, "-o", out, *SMALL, *options, "--json").json
        return made[key]
    return run


@pytest.fixture(scope="module")
def shape(tmp_path_factory):
    """shape(name, vertices, triangles) writes a mesh."""
    def write(name, vertices, triangles):
        path = tmp_path_factory.mktemp("shape") / name
        path.write_bytes(glb(vertices=vertices, triangles=triangles))
        return path
    return write


def lopsided(shape):
    """A tetrahedron that nothing carries into itself."""
    return shape("lopsided.glb", [(0, 0, 0), (0.3, 0, 0), (0.05, 0.2, 0), (0.1, 0.03, 0.15)],
                 [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])


def cylinder(shape, sides=32):
    ring = [(0.1 * math.cos(2 * math.pi * k / sides), 0.1 * math.sin(2 * math.pi * k / sides)) for k in range(sides)]
    vertices = [(x, y, -0.1) for x, y in ring] + [(x, y, 0.1) for x, y in ring] + [(0, 0, -0.1), (0, 0, 0.1)]
    triangles = []
    for k in range(sides):
        j = (k + 1) % sides
        triangles += [(k, j, k + sides), (j, j + sides, k + sides), (2 * sides, j, k),
                      (2 * sides + 1, k + sides, j + sides)]
    return shape("cylinder.glb", vertices, triangles)


@pytest.mark.parametrize("status, value, words", [
    (2, "0", "--speeds|0"), (2, "0.1,-1", "--speeds|-1"), (2, "0.1,x", "--speeds|x"), (2, "nan", "--speeds|nan"),
    (2, "1e9", "--speeds|1e9"), (1, ",".join(str(k) for k in range(1, 17)), "--speeds|at most 16|not 17"),
    (1, "0.1,0.1000000001", "--speeds|too near|0.1"), (1, "0.50000000001", "--speeds|too near|0.5")])
@pytest.mark.parametrize("command", [["bake"], ["bake", "plan"]], ids=["bake", "plan"])
def test_speeds_that_cannot_be(refused, box, tmp_path, command, status, value, words):
    refused(status, words, *command, box, "-o", tmp_path / "out", *SMALL, "--speeds", value)
    assert names(tmp_path) == []


def test_speeds(good, bake):
    one, plain = bake()
    several, said = bake("--speeds", "2,0.05,0.5")  # one of them is the base speed
    assert said["flows"] == 3 * plain["flows"] == 9
    info = good("info", several, "--json").json
    assert info["speeds"] == 3 and info["base_speed"] == 0.5
    assert sorted({flow["speed"] for flow in info["provenance"]["directions"]}) == [0.05, 0.5, 2]
    text = good("info", several).out
    assert "means at 3 speeds" in text and "0.05" in text.split("blockage")[1]
    assert "sound" in good("verify", several).out

    def force(path, speed):
        return good("force", path, "--velocity", f"{speed},0,0", "--json").json["force_mean"][0]
    # At the base speed and above the fastest nothing is added but that speed's own flow; far below it the drag of a
    # coefficient that rises as the Reynolds number falls. A box of sharp edges: not by much.
    assert force(several, 0.5) == pytest.approx(force(one, 0.5), rel=0.02)
    assert force(several, 0.05) != force(one, 0.05)
    assert force(several, 0.05) == pytest.approx(force(one, 0.05), rel=0.5)


def test_the_mesh_may_follow_the_speeds(refused, tmp_path):
    refused(1, "no.glb", "bake", *SMALL, "--speeds", "0.1,2", "no.glb", cwd=tmp_path)


def test_a_speed_that_is_the_base_speed_changes_nothing(good, box, bake, tmp_path):
    path, said = bake("--speeds", "0.5,0.5")
    assert said["flows"] == 3 and good("info", path, "--json").json["speeds"] == 1


def test_spin(good, bake):
    one, _ = bake()
    turned, said = bake("--spin")
    assert said["flows"] == 3 + 3  # a mirror makes the other way round of a turn
    info = good("info", turned, "--json").json
    assert info["has_spin"] and not good("info", one, "--json").json["has_spin"]
    assert len(info["provenance"]["spins"]) == 3
    text = good("info", turned).out
    assert "spin table           yes" in text and "turn about" in text and "{" not in text.split("turn about")[1]

    def wrench(path, *motion):
        j = good("force", path, *motion, "--json").json
        return j["force_mean"], j["torque_mean"]
    turn = ("--velocity", "0,0,0", "--spin", "0,0,3")
    about = wrench(turned, *turn)[1]
    assert about[2] < 0  # it brakes
    assert about[2] != pytest.approx(wrench(one, *turn)[1][2], rel=0.01)
    # A stream without a turn is untouched.
    assert wrench(turned, "--velocity", "0.5,0,0")[0] == pytest.approx(wrench(one, "--velocity", "0.5,0,0")[0], rel=1e-3)


def test_without_symmetry_every_direction_is_a_flow(good, bake):
    path, said = bake("--no-symmetry")
    assert said["flows"] == 6
    provenance = good("info", path, "--json").json["provenance"]
    assert provenance["symmetry"] == {"kind": "finite", "isometries": 1} and len(provenance["directions"]) == 6


def test_added_mass_can_be_left_out(good, bake):
    assert good("info", bake()[0], "--json").json["has_added_mass"]
    path, _ = bake("--no-added-mass")
    assert not good("info", path, "--json").json["has_added_mass"]
    assert "added mass           no" in good("info", path).out


def test_a_threshold_of_all_leaves_no_fluctuation(good, refused, box, bake, tmp_path):
    path, _ = bake("--threshold", "1")
    assert path.stat().st_size < bake()[0].stat().st_size
    velocity = ("--velocity", "0.5,0,0", "--json")
    assert good("force", path, *velocity).json["force_rms"] == pytest.approx([0, 0, 0], abs=1e-6)
    for bad in ("-0.1", "1.5", "nan", "x"):
        refused(2, "--threshold", "bake", box, "-o", tmp_path / "b.frm", *SMALL, "--threshold", bad)


def test_raw_tables_confirm_the_stated_error(good, refused, box, bake, tmp_path):
    raw = tmp_path / "box.frmraw"
    good("bake", box, "-o", tmp_path / "box.frm", *SMALL, "--speeds", "0.1", "--raw", raw)
    assert names(tmp_path) == ["box.frm", "box.frmraw"]
    assert "sound" in good("verify", tmp_path / "box.frm", "--against", raw).out
    refused(1, "another map", "verify", bake()[0], "--against", raw)


def test_a_mesh_without_symmetry(bake, good, shape):
    path, said = bake(mesh=lopsided(shape))
    assert said["flows"] == 6
    assert good("info", path, "--json").json["provenance"]["symmetry"]["isometries"] == 1


def test_a_sphere_is_one_flow(bake, good):
    path, said = bake("--spin", mesh=MESHES / "sphere.glb")
    assert said["flows"] == 2  # a stream and a turn
    info = good("info", path, "--json").json
    assert info["provenance"]["symmetry"]["kind"] == "spherical"
    # There is no other flow to predict it from.
    assert info["direction_error_rms"] is None and "not known" in good("info", path).out
    drag = [good("force", path, "--velocity", v, "--json").json["force_mean"] for v in ("0.5,0,0", "0,-0.3,0.4")]
    assert math.hypot(*drag[0]) == pytest.approx(math.hypot(*drag[1]), rel=0.02)
    assert drag[0][0] == pytest.approx(-math.hypot(*drag[0]), rel=1e-3)


def test_a_cylinder_is_solved_along_a_quarter_of_a_circle(bake, good, shape):
    path, said = bake("--spin", mesh=cylinder(shape))
    assert said["flows"] == 2 + 2  # along and across; about and across
    info = good("info", path, "--json").json
    assert info["provenance"]["symmetry"]["kind"] == "axial_mirrored"
    across = [good("force", path, "--velocity", v, "--json").json["force_mean"] for v in ("0.5,0,0", "0.3,-0.4,0")]
    assert math.hypot(*across[0]) == pytest.approx(math.hypot(*across[1]), rel=0.03)


def test_rounds_speeds_and_spins_merged_are_the_local_map(frm, good, tmp_path):
    """Standard quality, which adds directions; the folder's tasks are solved by others round after round."""
    options = ["--quality", "standard", "--resolution", "4", "--sources", "6", "--speeds", "0.1", "--spin"]
    cube, jobs = tmp_path / "cube.glb", tmp_path / "jobs"
    cube.write_bytes(glb())
    local = good("bake", cube, "-o", tmp_path / "local.frm", *options, "--json").json
    tasks = good("bake", "plan", cube, "-o", jobs, *options, "--json").json["tasks"]
    assert tasks < local["flows"]
    rounds = 0
    while (outcome := frm("bake", "merge", jobs, "-o", tmp_path / "merged.frm")).status != 0:
        assert outcome.status == (3 if rounds == 0 else 4) and rounds < 5, outcome.err
        good("bake", "solve", jobs)
        rounds += 1
    assert rounds >= 2
    assert (tmp_path / "merged.frm").read_bytes() == (tmp_path / "local.frm").read_bytes()
    info = good("info", tmp_path / "merged.frm", "--json").json
    assert info["speeds"] == 2 and info["has_spin"]
    assert len(info["provenance"]["directions"]) == local["flows"] - 1
