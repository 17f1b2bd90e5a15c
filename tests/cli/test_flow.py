"""frm flow: one short run of the solver."""
import array
import csv
import importlib.util
import io
import json
import math
import re
import signal
import subprocess

import pytest

from conftest import PROGRAM, names
from gltf import CUBE, SIDES, glb

HAS_MATPLOTLIB = importlib.util.find_spec("matplotlib") is not None
needs_matplotlib = pytest.mark.skipif(not HAS_MATPLOTLIB, reason="matplotlib is not there")

SHORT = ["--speed", "0.5", "--resolution", "8", "--start-up", "0.5", "--duration", "1"]
HEAD = "time,fx,fy,fz,fx_pressure,fy_pressure,fz_pressure,fx_friction,fy_friction,fz_friction,tx,ty,tz"


def rows_of(text):
    rows = list(csv.reader(io.StringIO(text)))
    assert ",".join(rows[0]) == HEAD
    return [[float(v) for v in row] for row in rows[1:]]


@pytest.fixture(scope="module")
def whole(good, box, tmp_path_factory):
    """(JSON, rows) of one run."""
    path = tmp_path_factory.mktemp("flow") / "series.csv"
    j = good("flow", box, "--direction", "-1,0,0", *SHORT, "--json", "-o", path).json
    return j, rows_of(path.read_text())


def test_json(whole):
    j, rows = whole
    for key in ("force_mean", "force_rms", "torque_mean"):
        assert len(j[key]) == 3 and all(math.isfinite(v) for v in j[key])
    for key in ("area", "reynolds", "cd", "cl", "cl_amplitude", "uncertainty", "seconds"):
        assert math.isfinite(j[key])
    assert j["ending"] == "duration" and j["torque_coefficient"] is None
    assert j["samples"] == len(rows) and rows[1][0] == pytest.approx(j["interval"], rel=1e-6)
    assert j["bytes"] > 0 and j["steps"] >= j["samples"] and j["cells"] == sum(b["cells"] for b in j["blocks"])
    for block in j["blocks"]:
        assert block["cell"] > 0 and all(low < high for low, high in zip(block["low"], block["high"]))
    assert j["strouhal"] is None or j["strouhal"] > 0
    assert j["force_mean"][0] < 0 < j["cd"] and j["area"] > 0
    assert j["reynolds"] == pytest.approx(0.5 * math.sqrt(j["area"]) / 1e-6)
    assert j["cd"] == pytest.approx(-j["force_mean"][0] / (0.5 * 1000 * 0.25 * j["area"]))


def test_rows_are_the_series_of_the_means(whole):
    j, rows = whole
    assert all(later[0] > row[0] for row, later in zip(rows, rows[1:]))
    for axis in range(3):
        mean = sum(row[1 + axis] for row in rows) / len(rows)
        assert mean == pytest.approx(j["force_mean"][axis], rel=1e-4, abs=1e-4)
        for row in rows:
            assert row[1 + axis] == pytest.approx(row[4 + axis] + row[7 + axis], rel=1e-4, abs=1e-3)


def test_the_series_goes_to_standard_output_alone(good, box, whole):
    outcome = good("flow", box, "--direction=-1,0,0", *SHORT, "--threads", 1)
    assert rows_of(outcome.out) == whole[1]
    assert "drag coefficient" in outcome.err


def test_length_changes_only_the_numbers_that_are_named_after_it(good, box, whole):
    j = good("flow", box, "--direction", "-1,0,0", *SHORT, "--json", "--length", "2").json
    assert j["reynolds"] == pytest.approx(1e6)
    for key in ("force_mean", "force_rms", "torque_mean", "area", "cd", "cl", "uncertainty"):
        assert j[key] == whole[0][key]
    if j["strouhal"]:
        assert j["strouhal"] / whole[0]["strouhal"] == pytest.approx(2 / whole[0]["length"])


def test_a_section(good, box, refused):
    direction = ["--direction", "-1,0,0"]
    bare = good("flow", "--section", box, *direction, *SHORT, "--json").json  # the mesh is not the section's normal
    assert good("flow", box, *direction, *SHORT, "--json", "--section").json["force_mean"] == bare["force_mean"]
    named = {n: good("flow", box, *direction, *SHORT, "--json", "--section", n).json for n in ("0,0,1", "-0,1,0")}
    assert named["0,0,1"]["area"] != named["-0,1,0"]["area"]
    assert bare["force_mean"] in [j["force_mean"] for j in named.values()]
    refused(2, "--section|right angles", "flow", box, *direction, *SHORT, "--section", "-1,0,0")
    refused(1, "--section|normal", "flow", box, "--direction", "1,1,1", *SHORT, "--section")


def test_a_section_of_two_bodies_goes_where_it_is_put(good, refused, tmp_path):
    """Two cubes 0.2 m apart across the stream and at two heights: between them, where the centroid is, is nothing."""
    mesh = tmp_path / "two.glb"
    two = [tuple(a + b for a, b in zip(v, by)) for by in ((0, 0, 0), (0, 0.3, 0.15)) for v in CUBE]
    mesh.write_bytes(glb(vertices=two, triangles=SIDES + [tuple(i + 8 for i in t) for t in SIDES]))
    cut = ["flow", mesh, "--direction", "1,0,0", *SHORT, "--no-grid-error", "--section", "0,0,1"]
    refused(1, "--section-point (0.05, 0.2, 0.125) does not cut the body", *cut)
    one = good(*cut, "--section-point", "0,0,0.05", "--json").json
    assert one["area"] == pytest.approx(0.1, rel=1e-6)
    # Across z both are cut, as seen along y one behind the other, along x beside each other.
    both = ["flow", mesh, *SHORT, "--no-grid-error", "--section", "0,1,0", "--section-point", "0,0.05,0", "--json"]
    assert good(*both, "--direction", "1,0,0").json["area"] == pytest.approx(0.1, rel=1e-6)
    beside = [tuple(c + (0.3 if i >= 8 and k == 1 else 0) for k, c in enumerate((CUBE + CUBE)[i])) for i in range(16)]
    mesh.write_bytes(glb(vertices=beside, triangles=SIDES + [tuple(i + 8 for i in t) for t in SIDES]))
    across = good(*cut, "--json").json
    assert across["area"] == pytest.approx(0.2, rel=1e-6) and across["length"] == pytest.approx(0.4, rel=1e-6)
    assert across["cd"] == pytest.approx(across["force_mean"][0] / (0.5 * 1000 * 0.25 * 0.2), rel=1e-5)
    refused(2, "--section-point|--section", "flow", mesh, "--direction", "1,0,0", *SHORT, "--section-point", "0,0,0")


def test_a_mesh_in_millimetres_can_be_scaled(good, box, tmp_path):
    (tmp_path / "mm.glb").write_bytes(glb(vertices=[tuple(1000 * c for c in v) for v in CUBE]))
    (tmp_path / "m.glb").write_bytes(glb())
    run = ["--direction", "1,0,0", *SHORT, "--no-grid-error", "--json"]
    scaled = good("flow", tmp_path / "mm.glb", "--scale", "0.001", *run)
    assert scaled.json["force_mean"] == pytest.approx(good("flow", tmp_path / "m.glb", *run).json["force_mean"], rel=1e-4)
    assert "glTF counts in metres" not in scaled.err
    assert "in centimetres, add --scale 0.01 (1 m)" in good("flow", tmp_path / "mm.glb", *run).err


def test_what_the_solver_refuses_is_said_in_options(refused, box):
    run = ["flow", box, "--direction", "1,0,0", "--speed", "0.5"]
    refused(1, "limit (--memory) is 1.024 MiB", *run, "--memory", "0.001")
    refused(1, "--start-up and duration together", *run, "--start-up", "10000", "--duration", "100000", "--resolution",
            "500", "--memory", "100000")


def test_water_that_is_too_thick_is_refused(refused, box):
    refused(1, "Reynolds", "flow", box, "--direction", "1,0,0", *SHORT, "--viscosity", "100")

SECTION = ["--direction", "-1,0,0", "--speed", "0.5", "--section", "--resolution", "8", "--start-up", "0.5"]
LONG = [*SECTION, "--duration", "20000", "--no-grid-error"]


def test_what_the_run_takes_is_said_before_it(good, box):
    outcome = good("flow", box, "--direction", "-1,0,0", *SHORT, "--json")
    plan = [line for line in outcome.err.splitlines() if "MiB" in line]
    assert len(plan) == 1
    assert re.fullmatch(r"[\d.e+]+ (million )?cells in \d+ blocks?, finest [\d.e+-]+ mm; \d+ MiB; "
                        r"Reynolds number [\d.e+]+ \(solved [\d.e+]+\)", plan[0])


def test_the_uncertainty_and_its_parts(good, box, whole):
    parts = whole[0]["uncertainty_parts"]
    assert set(parts) == {"grid", "statistics", "blockage"} and all(v >= 0 for v in parts.values())
    assert whole[0]["uncertainty"] == pytest.approx(math.sqrt(sum(v * v for v in parts.values())))
    assert math.isfinite(whole[0]["cd_coarse"]) and whole[0]["cd_coarse"] != 0
    outcome = good("flow", box, *SECTION, "--duration", "1", "--no-grid-error", "--json")
    assert outcome.json["uncertainty_parts"]["grid"] is None and outcome.json["cd_coarse"] is None
    text = good("flow", box, *SECTION, "--duration", "1", "--no-grid-error").err
    assert "grid not measured, statistics" in text and "stopped" not in text


def test_confidence_ends_a_run(good, box):
    outcome = good("flow", box, *SECTION, "--duration", "1000", "--confidence", "40", "--json")
    j = outcome.json
    assert j["ending"] == "confidence" and j["uncertainty_parts"]["statistics"] <= 0.4
    assert j["samples"] * j["interval"] < 0.5 * 1000 * j["length"] / 0.5
    assert "stopped early: the confidence" in outcome.err


def test_a_confidence_that_is_not_reached_is_told(good, box, tmp_path):
    outcome = good("flow", box, *SECTION, "--duration", "1", "--confidence", "0.1", "-o", tmp_path / "s.csv")
    assert "--confidence 0.1 is not reached" in outcome.err and "--duration" in outcome.err


def test_seconds_end_a_run(good, box, tmp_path):
    outcome = good("flow", box, *LONG, "--seconds", "1", "--json", "-o", tmp_path / "s.csv")
    assert outcome.json["ending"] == "seconds" and 0.9 < outcome.json["seconds"] < 30
    assert "stopped early: the time of --seconds" in outcome.err
    assert len(rows_of((tmp_path / "s.csv").read_text())) == outcome.json["samples"] > 0


def interrupted(arguments, cwd):
    """(status, stdout, stderr, progress line) of a run that gets Ctrl-C once it has shown how far it is."""
    process = subprocess.Popen([PROGRAM, "flow", *map(str, arguments)], text=True, cwd=cwd, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE)
    line = before = ""
    while not line.startswith("flow: "):
        before, line = before + line, process.stderr.readline()
        assert line, before
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=200)
    return process.returncode, out, err, line


def test_an_interrupted_run_says_what_is_known(box, tmp_path):
    report = ["--report", "report"] if HAS_MATPLOTLIB else []
    status, out, err, line = interrupted([box, *LONG, "--json", "-o", "s.csv", *report], tmp_path)
    assert "%" in line and "drag " in line
    assert status == 1 and "stopped early: interrupted" in err
    j = json.loads(out)
    assert j["ending"] == "cancelled" and math.isfinite(j["cd"])
    assert len(rows_of((tmp_path / "s.csv").read_text())) == j["samples"] > 0
    assert names(tmp_path) == [*report[1:], "s.csv"]
    if report:
        assert "interrupted" in (tmp_path / "report" / "report.html").read_text()


@needs_matplotlib
def test_who_reads_standard_output_may_go(box, tmp_path):
    """And what another run of this report left when it was killed is gone."""
    dead = subprocess.Popen(["true"])
    dead.wait()
    (tmp_path / "report" / f".frm_report.tmp{dead.pid}").mkdir(parents=True)
    run = subprocess.Popen([PROGRAM, "flow", box, "--direction", "-1,0,0", *SHORT, "--json", "--report", "report"],
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path)
    run.stdout.close()
    err = run.stderr.read()
    assert run.wait(timeout=200) == 1 and "frm:" not in err
    assert names(tmp_path / "report") == ["flow.json", "report.html", "series.csv", "slices.f32"]


def test_a_coarse_run_says_that_its_grid_is_not_measured(good, box):
    text = good("flow", box, *SECTION[:-4], "--resolution", "7", "--start-up", "0.5", "--duration", "1").err
    assert "note: on under 8 cells" in text and "at least" in text


def test_a_run_interrupted_before_its_series_leaves_nothing(box, tmp_path):
    arguments = [*SECTION, "--no-grid-error", "-o", "s.csv"]
    arguments[arguments.index("--start-up") + 1] = "9000"
    report = ["--report", "a/b"] if HAS_MATPLOTLIB else []
    status, out, err, line = interrupted([box, *arguments, *report], tmp_path)
    assert "starting" in line
    assert status == 1 and out == "" and "nothing was written" in err
    assert names(tmp_path) == []


def test_spin(good, box):
    sphere = box.parent / "sphere.glb"
    spin = ["--direction", "1,0,0", "--resolution", "8", "--start-up", "0.5", "--duration", "1", "--spin", "0,0,2",
            "--no-grid-error", "--json"]
    with_stream = good("flow", sphere, *spin, "--speed", "0.1").json
    assert math.isfinite(with_stream["cd"]) and with_stream["torque_coefficient"] > 0
    alone = good("flow", sphere, *spin, "--speed", "0").json
    assert alone["torque_coefficient"] > 0 and alone["reynolds"] > 0 and alone["uncertainty"] > 0
    for key in ("cd", "cd_coarse", "cl", "cl_rms", "cl_amplitude", "strouhal"):
        assert alone[key] is None


def test_any_mesh_turns_in_still_water(good, refused, box):
    short = ["--resolution", "8", "--start-up", "0.5", "--duration", "0.5", "--no-grid-error", "--spin", "0,0,2"]
    j = good("flow", box, *short, "--speed", "0", "--json").json
    assert j["torque_mean"][2] < 0 and j["torque_coefficient"] > 0 and j["cd"] is None
    refused(1, "revolution|set speed to 0", "flow", box, *short, "--speed", "0.1", "--direction", "1,0,0")


def test_slab_and_turn(good, box, whole):
    j = good("flow", box, *SECTION, "--duration", "1", "--slab", "1", "--no-grid-error", "--json").json
    assert math.isfinite(j["cd"]) and j["area"] == pytest.approx(
        good("flow", box, *SECTION, "--duration", "1", "--no-grid-error", "--json").json["area"])
    turned = good("flow", box, "--direction", "-1,0,0", *SHORT, "--turn", "30", "--json").json
    assert turned["force_mean"] != whole[0]["force_mean"] and turned["area"] == pytest.approx(whole[0]["area"])


def test_too_little_memory_is_refused_before_the_run(refused, box, tmp_path):
    refused(1, "MiB", "flow", box, "--direction", "1,0,0", *SHORT, "--memory", "0.001", "-o", "s.csv", cwd=tmp_path)
    assert names(tmp_path) == []


@needs_matplotlib
def test_report(good, box, tmp_path):
    folder = tmp_path / "new" / "the report"
    outcome = good("flow", box, "--direction", "-1,0,0", *SHORT, "--report", folder, "--json", "-o", tmp_path / "s.csv")
    files = ["flow.json", "report.html", "series.csv", "slices.f32"]
    assert names(folder) == files and names(tmp_path) == ["new", "s.csv"] and names(tmp_path / "new") == [folder.name]
    j = json.loads((folder / "flow.json").read_text())
    report = j.pop("report")
    assert j == outcome.json and report["format"] == "frm flow report 1"
    assert (folder / "series.csv").read_bytes() == (tmp_path / "s.csv").read_bytes()
    values = array.array("f", (folder / "slices.f32").read_bytes())
    assert {one["normal"] for one in report["slices"]} == {1, 2}
    assert len(values) == 2 * sum(one["rows"] * one["columns"] for one in report["slices"])
    for one in report["slices"]:
        speed = values[one["offset"]:one["offset"] + one["rows"] * one["columns"]]
        assert any(map(math.isnan, speed)) and any(v > 0 for v in speed)  # the body is in it, and water
    page = (folder / "report.html").read_text()
    assert page.count("<img ") >= 6 and all(words in page for words in ("Drag coefficient", "half the resolution"))

    # An older report is replaced.
    text = good("flow", box, *SECTION, "--duration", "1", "--report", folder).out
    assert "report in " in text and "time,fx" not in text
    assert names(folder) == files and json.loads((folder / "flow.json").read_text())["cd"] != j["cd"]


@needs_matplotlib
def test_a_folder_with_other_files_is_left_alone(refused, box, tmp_path):
    for name, held in (("other", "flow.json"), ("more", "notes.txt")):
        (tmp_path / name).mkdir()
        (tmp_path / name / held).write_text("{}")
        refused(1, f"--report|{name}|other files", "flow", box, *SECTION, "--report", tmp_path / name)
        assert names(tmp_path / name) == [held]
    (tmp_path / "file").write_text("")
    refused(1, "--report|file|not a folder", "flow", box, *SECTION, "--report", tmp_path / "file")
    refused(1, "two outputs", "flow", box, *SECTION, "--report", tmp_path / "x", "-o", tmp_path / "x" / "series.csv")
    assert names(tmp_path) == ["file", "more", "other"]
