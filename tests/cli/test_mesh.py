"""frm mesh: meshes as they are found, what is repaired, and the file that shows why one is refused."""
import json
import math
import struct
import subprocess
import sys

import pytest

from conftest import MESHES, PROGRAM, ROOT, names
from gltf import CUBE, SIDES, glb

FLIPPED = [(a, c, b) if i % 3 == 1 else (a, b, c) for i, (a, b, c) in enumerate(SIDES)]


def moved(vertices, by):
    return [tuple(a + b for a, b in zip(v, by)) for v in vertices]


def joined(*parts):
    """(vertices, triangles) of several."""
    vertices, triangles = [], []
    for v, t in parts:
        triangles += [tuple(i + len(vertices) for i in corners) for corners in t]
        vertices += v
    return {"vertices": vertices, "triangles": triangles}


def ball(rings=60, around=120):
    """A ball of 0.2 m with small triangles, all of equal angle."""
    vertices = [(0, 0, 0.1)]
    for i in range(1, rings):
        for j in range(around):
            a, b = math.pi * i / rings, 2 * math.pi * j / around
            vertices.append((0.1 * math.sin(a) * math.cos(b), 0.1 * math.sin(a) * math.sin(b), 0.1 * math.cos(a)))
    vertices.append((0, 0, -0.1))

    def at(i, j):
        return 0 if i == 0 else len(vertices) - 1 if i == rings else 1 + (i - 1) * around + j % around
    triangles = []
    for i in range(rings):
        for j in range(around):
            if i + 1 < rings:
                triangles.append((at(i, j), at(i + 1, j), at(i + 1, j + 1)))
            if i > 0:
                triangles.append((at(i, j), at(i + 1, j + 1), at(i, j + 1)))
    return vertices, triangles


@pytest.fixture
def mesh_of(tmp_path):
    def write(name="mesh.glb", **shape):
        path = tmp_path / name
        path.write_bytes(glb(**shape))
        return path
    return write


@pytest.fixture
def shown(good, mesh_of):
    """shown(shape) writes it and gives the JSON of frm mesh."""
    return lambda **shape: good("mesh", mesh_of(**shape), "--json").json


def read(path):
    """The positions of each node's triangles in a .glb, by name, read by hand from the specification."""
    data = path.read_bytes()
    magic, version, length, size, kind = struct.unpack_from("<4sIIII", data)
    assert (magic, version, length, kind) == (b"glTF", 2, len(data), 0x4E4F534A)
    j = json.loads(data[20:20 + size])
    binary_size, binary_kind = struct.unpack_from("<II", data, 20 + size)
    assert binary_kind == 0x004E4942 and size % 4 == 0 and binary_size == length - 28 - size
    binary = data[28 + size:]
    assert j["asset"]["version"] == "2.0" and j["buffers"] == [{"byteLength": len(binary)}]

    def numbers(index, form, width):
        accessor = j["accessors"][index]
        view = j["bufferViews"][accessor["bufferView"]]
        assert view["byteOffset"] % 4 == 0 and view["byteLength"] == 4 * width * accessor["count"]
        return list(struct.iter_unpack(f"<{width}{form}", binary[view["byteOffset"]:][:view["byteLength"]])), accessor
    result = {}
    for node in (j["nodes"][n] for n in j["scenes"][j["scene"]]["nodes"]):
        primitive, = j["meshes"][node["mesh"]]["primitives"]
        positions, accessor = numbers(primitive["attributes"]["POSITION"], "f", 3)
        for i in range(3):
            assert accessor["min"][i] == min(p[i] for p in positions)
            assert accessor["max"][i] == max(p[i] for p in positions)
        corners, _ = numbers(primitive["indices"], "I", 1)
        colour = j["materials"][primitive["material"]]["pbrMetallicRoughness"]["baseColorFactor"]
        result[node["name"]] = ([positions[c[0]] for c in corners], colour)
    return result


def test_what_it_says_of_a_box(good, box):
    j = good("mesh", box, "--json").json
    assert j["triangles"] == 12 and j["vertices"] == 8 and j["shells"] == 1 and j["notes"] == []
    assert j["size"] == pytest.approx([0.4, 0.3, 0.2]) and j["volume"] == pytest.approx(0.024)
    assert j["area"] == pytest.approx(0.52) and j["thinnest"] == pytest.approx(0.2)
    text = good("mesh", box)
    assert text.err == ""
    for words in ("0.4 x 0.3 x 0.2 m", "12 triangles", "1 closed piece\n", "0.024 m^3", "200 mm", "none needed",
                  "8 elements: 4 rotations, 4 reflections"):
        assert words in text.out
    assert j["symmetry"]["kind"] == "finite" and len(j["symmetry"]["elements"]) == 8
    assert j["symmetry"]["elements"][0] == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert j["symmetry"]["worst"] <= j["symmetry"]["tolerance"] < 0.001
    assert "regions" not in j and "quality" not in text.out


def test_the_regions_that_it_needs(good, box):
    choices = good("mesh", box, "--regions", "--json").json["regions"]
    assert [c["quality"] for c in choices] == ["draft", "standard", "high"]
    assert 6 <= choices[0]["count"] < choices[1]["count"] < choices[2]["count"]
    lines = [line.split() for line in good("mesh", box, "--regions").out.splitlines()]
    for c in choices:
        assert c["within_budget"] and c["error"] <= c["budget"]
        assert max(c["wet_ratio"], c["velocity"], c["arm"]) <= c["error"]  # so it is for a box; not in general
        line, = [x for x in lines if x and x[0] == c["quality"]]
        assert line[3] == str(c["count"]) and float(line[4]) == pytest.approx(100 * c["error"], abs=0.06)


@pytest.mark.parametrize("node, volume, low", [
    ({"scale": [2, 3, 4]}, 0.024, [0, 0, 0]),
    ({"scale": [-1, 1, 1]}, 0.001, [-0.1, 0, 0]),
    ({"scale": [-2, -2, -2], "translation": [1, 1, 1]}, 0.008, [0.8, 0.8, 0.8]),
    ({"matrix": [0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]}, 0.001, [5, 6, 7]),
], ids=["scaled", "mirrored", "turned inside out", "matrix"])
def test_scaled_and_mirrored_nodes(shown, node, volume, low):
    j = shown(nodes=[{"mesh": 0, **node}])
    assert j["volume"] == pytest.approx(volume, rel=1e-5) and j["low"] == pytest.approx(low, abs=1e-6)
    assert j["notes"] == []


def test_a_scale_and_a_size_that_is_not_plausible(good, tmp_path):
    mesh = tmp_path / "mm.glb"
    mesh.write_bytes(glb(vertices=[tuple(1000 * c for c in v) for v in CUBE]))
    shown = good("mesh", mesh, "--scale", "0.001", "-o", tmp_path / "m.glb", "--json").json
    assert shown["volume"] == pytest.approx(1e-3, rel=1e-5) and shown["notes"] == []
    assert good("mesh", tmp_path / "m.glb", "--json").json["volume"] == pytest.approx(1e-3, rel=1e-5)
    assert "in inches --scale 0.0254 (2.54 m)" in good("mesh", mesh).out


def test_several_shells(shown):
    j = shown(**joined((CUBE, SIDES), (moved(CUBE, (0.3, 0, 0)), FLIPPED), (moved(CUBE, (0, 0.05, 0.3)), SIDES)))
    assert j["shells"] == 3 and j["volume"] == pytest.approx(0.003) and j["cuts_between"] == 0
    through = shown(**joined((CUBE, SIDES), (moved(CUBE, (0.03, 0.02, 0.01)), SIDES)))
    assert through["shells"] == 2 and through["cuts_between"] > 0
    assert any("run into each other" in note and "near (" in note for note in through["notes"])


def test_flipped_normals(shown):
    j = shown(triangles=FLIPPED)
    assert j["volume"] == pytest.approx(0.001) and j["notes"] == ["turned 4 triangles the same way round as their "
                                                                  "neighbours"]


def test_inner_faces(shown):
    inside = [(0.02, 0.02, 0.05), (0.08, 0.02, 0.05), (0.05, 0.08, 0.05)]
    j = shown(**joined((CUBE, SIDES), (inside, [(0, 1, 2)])))
    assert j["triangles"] == 12 and j["volume"] == pytest.approx(0.001)
    assert j["notes"] == ["removed 1 triangle of walls inside the shape (water cannot reach them)"]
    wall = shown(triangles=SIDES + [(0, 3, 7), (0, 7, 4)])  # across the box, from edge to edge
    assert wall["triangles"] == 12 and "2 triangles of walls inside" in wall["notes"][0]


def test_tiny_holes(good, mesh_of, tmp_path):
    vertices, triangles = ball()
    whole = good("mesh", mesh_of("whole.glb", vertices=vertices, triangles=triangles), "--json").json
    holed = mesh_of(vertices=vertices, triangles=triangles[:5000] + triangles[5001:9000] + triangles[9002:])
    j = good("mesh", holed, "--json", "-o", tmp_path / "closed.glb").json
    # A patch is flat: what it can lose is less than its area times a hundredth of the ball's radius.
    assert j["volume"] == pytest.approx(whole["volume"], rel=1e-6)
    assert len(j["notes"]) == 1 and j["notes"][0].startswith("closed 2 holes of at most 5.")
    assert " mm, near (" in j["notes"][0]
    again = good("mesh", tmp_path / "closed.glb", "--json").json
    assert again["notes"] == [] and again["triangles"] == len(triangles)
    assert again["volume"] == pytest.approx(j["volume"], rel=1e-6)


def test_a_large_hole_is_shown(refused, good, mesh_of, tmp_path):
    mesh = mesh_of(triangles=SIDES[:2] + SIDES[4:])  # no lid, z = 0.1
    refused(1, "4 boundary edges around 1 hole, 100 mm across|0.1) m|marked red in mesh.problem.glb", "mesh", mesh,
            "--json", cwd=tmp_path)
    assert names(tmp_path) == ["mesh.glb", "mesh.problem.glb"]
    parts = read(tmp_path / "mesh.problem.glb")
    assert list(parts) == ["surface", "problem"]
    surface, grey = parts["surface"]
    assert sorted(surface) == sorted(tuple(struct.unpack("<3f", struct.pack("<3f", *CUBE[i])))
                                     for t in SIDES[:2] + SIDES[4:] for i in t)
    marked, red = parts["problem"]
    assert grey[0] == grey[1] == grey[2] and red[0] > 0.5 and red[1] == red[2] == 0 and red[3] == 1
    for x, y, z in marked:  # the rim, with bars of 0.6 mm
        assert abs(z - 0.1) < 4e-4 and min(abs(v - edge) for v in (x, y) for edge in (0, 0.1)) < 4e-4
    for i in range(2):
        assert min(p[i] for p in marked) == pytest.approx(0, abs=4e-4)
        assert max(p[i] for p in marked) == pytest.approx(0.1, abs=4e-4)
    # Its bars are closed, so what frm says of the file is what it said of the mesh.
    refused(1, "4 boundary edges|mesh.problem.problem.glb", "mesh", tmp_path / "mesh.problem.glb", cwd=tmp_path)


def test_a_sheet_is_refused(refused, mesh_of, tmp_path):
    sail = [(x / 10, y / 10, 0.02 * math.sin(x / 3) * math.sin(y / 3)) for y in range(11) for x in range(11)]
    cells = [(x + 11 * y, x + 1 + 11 * y, x + 11 + 11 * y, x + 12 + 11 * y) for y in range(10) for x in range(10)]
    refused(1, "open sheet without thickness|Solidify|problem.glb", "mesh",
            mesh_of(vertices=sail, triangles=[t for a, b, c, d in cells for t in ((a, b, c), (b, d, c))]), cwd=tmp_path)
    marked, _ = read(tmp_path / "mesh.problem.glb")["problem"]
    assert len(marked) == 40 * 36  # a bar for each edge of the rim


def test_non_manifold_is_refused_and_marked(refused, mesh_of, tmp_path):
    tip = (0.05, 0.05, -0.4)  # a tent from the rim of the lid, out through the floor
    mesh = mesh_of(vertices=CUBE + [tip], triangles=SIDES + [(4, 5, 8), (5, 7, 8), (7, 6, 8), (6, 4, 8)])
    refused(1, "4 edges shared by more than two|problem.glb", "mesh", mesh, cwd=tmp_path)
    marked, _ = read(tmp_path / "mesh.problem.glb")["problem"]
    assert len(marked) == 4 * 36 and all(abs(z - 0.1) < 0.002 for x, y, z in marked)


@pytest.mark.parametrize("command, options", [
    ("mesh", []), ("flow", ["--direction", "1,0,0", "--speed", "1"]), ("bake", ["-o", "sub/out.frm"])])
def test_where_the_problem_file_goes(refused, mesh_of, tmp_path, command, options):
    (tmp_path / "sub").mkdir()
    mesh = mesh_of("a hull.glb", triangles=SIDES[2:])
    expected = "sub/a hull.problem.glb" if options[:1] == ["-o"] else "a hull.problem.glb"
    line = refused(1, "open", command, mesh, *options, cwd=tmp_path)
    assert line.endswith("; the place is marked red in " + expected)
    assert "problem" in read(tmp_path / expected)
    assert len(list(tmp_path.rglob("*"))) == 3


def test_files_of_the_user_stay(refused, frm, mesh_of, tmp_path):
    mesh = mesh_of(triangles=SIDES[2:])
    (tmp_path / "mesh.problem.glb").write_bytes(glb())
    (tmp_path / "mesh.problem-2.glb").symlink_to(tmp_path / "elsewhere")
    for _ in range(2):  # the second run replaces its own file
        refused(1, "open|mesh.problem-3.glb", "mesh", mesh, cwd=tmp_path)
    assert (tmp_path / "mesh.problem.glb").read_bytes() == glb()
    assert names(tmp_path) == ["mesh.glb", "mesh.problem-2.glb", "mesh.problem-3.glb", "mesh.problem.glb"]
    refused(1, "open|out.problem-2.glb", "mesh", mesh_of("out.glb", triangles=SIDES[2:]), "-o",
            tmp_path / "out.problem.glb", cwd=tmp_path)
    assert not (tmp_path / "out.problem.glb").exists()


def test_a_failed_write_does_not_hide_the_error(refused, mesh_of, tmp_path):
    mesh = mesh_of(triangles=SIDES[2:])
    for name in ["mesh.problem.glb"] + [f"mesh.problem-{i}.glb" for i in range(2, 10)]:
        (tmp_path / name).mkdir()
    refused(1, "the surface is open|no file with the place marked could be written|mesh.problem-9.glb", "mesh", mesh,
            cwd=tmp_path)


def test_the_mesh_is_not_overwritten(refused, mesh_of):
    mesh = mesh_of()
    refused(1, "mesh.glb|another file", "mesh", mesh, "-o", mesh)
    assert mesh.read_bytes() == glb()


def test_a_refused_file_without_a_place_leaves_nothing(refused, tmp_path):
    mesh = tmp_path / "mesh.glb"
    mesh.write_bytes(glb()[:200])
    refused(1, "cut off", "mesh", mesh, "-o", tmp_path / "out.glb", cwd=tmp_path)
    assert names(tmp_path) == ["mesh.glb"]


def test_a_table_of_many(frm, mesh_of, tmp_path):
    def table(*paths, program=PROGRAM):
        done = subprocess.run([sys.executable, "-B", ROOT / "scripts" / "try_meshes", "--frm", program, *paths],
                              capture_output=True, text=True)
        return done.returncode, done.stdout.splitlines()[2:]
    mesh_of("open.glb", triangles=SIDES[2:])
    mesh_of("other.GLB", triangles=FLIPPED)
    status, rows = table(tmp_path, MESHES / "box.glb")
    assert status == 0 and len(rows) == 3 and names(tmp_path) == ["open.glb", "other.GLB"]
    assert "open.glb` | refused: the surface is open" in rows[0]
    assert "loaded: 12 triangles" in rows[1] and "; turned 4 triangles" in rows[1]
    assert rows[2].startswith("| `meshes/box.glb` | loaded: 12 triangles, 0.4 x 0.3 x 0.2 m, 0.024 m^3 |")
    assert table(tmp_path, program="/bin/false")[0] == 1


def test_added_mass_is_shown_on_request(good):
    sphere = MESHES / "sphere.glb"
    assert "added_mass" not in good("mesh", sphere, "--json").json
    j = good("mesh", sphere, "--added-mass", "--density", 1025, "--json").json
    mass = j["added_mass"]
    assert mass["density"] == 1025 and mass["error"] < 0.02 and mass["buried"] == 0
    assert len(mass["matrix"]) == 6 and all(len(row) == 6 for row in mass["matrix"])
    for i in range(3):
        assert mass["matrix"][i][i] == pytest.approx(0.5 * 1025 * j["volume"], rel=0.005)
    text = good("mesh", sphere, "--added-mass").out
    assert "added mass at 1000 kg/m^3" in text and "force x" in text and "torque z" in text


def test_added_mass_needs_a_sensible_density(refused):
    sphere = MESHES / "sphere.glb"
    refused(2, "--density|--added-mass", "mesh", sphere, "--density", 1025)
    refused(2, "--density", "mesh", sphere, "--added-mass", "--density", -1)
