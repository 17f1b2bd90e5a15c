"""frm bake --report: what it leaves, and that the map is the same with it and without."""
import array
import importlib.util
import json
import math
import os
import re
import shutil
import subprocess

import pytest

from conftest import names

HAS_MATPLOTLIB = importlib.util.find_spec("matplotlib") is not None
needs_matplotlib = pytest.mark.skipif(not HAS_MATPLOTLIB, reason="matplotlib is not there")

SMALL = ["--directions", "6", "--sources", "6", "--resolution", "4", "--quality", "draft"]
FILES = ["bake.f32", "bake.json", "report.html"]


@pytest.fixture(scope="module")
def bare(good, box, tmp_path_factory):
    """A map that was baked without a report; its flows are kept beside it."""
    path = tmp_path_factory.mktemp("bare") / "box.frm"
    good("bake", box, "-o", path, *SMALL, "--keep", "--work", path.parent / "work")
    return path


@pytest.fixture(scope="module")
def reported(good, box, bare, tmp_path_factory):
    """(map, folder of the report, outcome)"""
    folder = tmp_path_factory.mktemp("reported")
    outcome = good("bake", box, "-o", folder / "box.frm", *SMALL, "--report", folder / "a new" / "report")
    return folder / "box.frm", folder / "a new" / "report", outcome


def array_of(values, described):
    rows, width = described["shape"]
    flat = values[described["offset"]:described["offset"] + rows * width]
    assert len(flat) == rows * width
    return [flat[row * width:(row + 1) * width] for row in range(rows)]


@needs_matplotlib
def test_the_map_is_the_same_with_a_report(bare, reported):
    path, folder, outcome = reported
    assert path.read_bytes() == bare.read_bytes()
    assert names(folder) == FILES and names(folder.parent) == ["report"]
    assert names(path.parent) == ["a new", "box.frm"]
    assert f"report in {folder}/report.html" in outcome.out


@needs_matplotlib
def test_the_page_stands_alone(reported):
    page = (reported[1] / "report.html").read_text()
    assert not re.search(r"https?:|<script|<link|@import|url\(", re.sub(r'src="data:[^"]*"', "", page))
    # Body, directions, fluctuations, the key of the slices, and three flows.
    assert page.count("<img ") == 7
    for words in ("box.glb", "Stated errors", "Flow by flow", "Added mass"):
        assert words in page


@needs_matplotlib
def test_the_data_is_that_of_the_map(good, reported):
    path, folder, _ = reported
    j = json.loads((folder / "bake.json").read_text())
    values = array.array("f", (folder / "bake.f32").read_bytes())
    info = good("info", path, "--json").json
    baked = info["provenance"]["directions"]
    assert len(baked) == len(j["flows"]) == 3
    for flow, said in zip(j["flows"], baked):
        assert flow["direction"] == said["direction"] and flow["cells"] == said["cells"]
        assert flow["cd"] == pytest.approx(said["drag_coefficient"], rel=1e-9)
        assert flow["uncertainty"] == pytest.approx(said["uncertainty"], rel=1e-9)
        series = array_of(values, flow["series"])
        assert len(series) == flow["samples"] and len(series[0]) == 6
        for axis in range(3):
            mean = sum(row[axis] for row in series) / len(series)
            assert mean == pytest.approx(flow["force_mean"][axis], rel=1e-4, abs=1e-4)
        # A box face-on is solved once for both sides.
        images = array_of(values, flow["images"])
        assert len(images) == 2 and images[0].tolist() == pytest.approx(flow["direction"])
        assert flow["slice"]["shape"][1] <= 180
        speed = [v for row in array_of(values, flow["slice"]) for v in row]
        assert any(map(math.isnan, speed)) and any(v > 0.5 for v in speed)  # the body is in it, and water
    errors = j["errors"]
    assert max(flow["left_out"] for flow in j["flows"]) == pytest.approx(errors["direction_worst"], rel=1e-9)
    assert errors["direction_worst"] == pytest.approx(info["direction_error_worst"], rel=1e-5)
    assert errors["rounding"] == pytest.approx(info["quantisation_error"], rel=1e-5) and errors["rounding"] <= 5e-3
    assert j["budgets"]["regions"] is None and j["budgets"]["direction_rms"] is None
    assert len(array_of(values, j["surface"]["sources"])) == info["sources"] == 6
    assert array_of(values, j["surface"]["region_begin"])[-1][0] == j["surface"]["triangles"]["shape"][0]
    # The mean force in one of the map's directions is what the map gives there.
    means = array_of(values, j["means"])
    assert len(means) == info["directions"]
    ahead = next(row for row in means if row[0] > 0.999)
    force = good("force", path, "--velocity", "-0.5,0,0", "--json").json["force_mean"]
    # The other is a mean over samples of a period, in which the rounded fluctuation does not quite cancel.
    assert list(ahead[3:]) == pytest.approx(force, abs=1e-3 * ahead[3])


@needs_matplotlib
def test_a_merged_bake_has_the_same_report(good, box, bare, reported, tmp_path):
    good("bake", "plan", box, "-o", tmp_path / "jobs", *SMALL)
    good("bake", "solve", tmp_path / "jobs")
    good("bake", "merge", tmp_path / "jobs", "-o", tmp_path / "box.frm", "--report", tmp_path / "report")
    assert (tmp_path / "box.frm").read_bytes() == bare.read_bytes()
    assert names(tmp_path / "report") == FILES
    assert (tmp_path / "report" / "bake.f32").read_bytes() == (reported[1] / "bake.f32").read_bytes()


@needs_matplotlib
def test_an_older_report_is_replaced_and_other_files_are_not(good, refused, box, bare, tmp_path):
    shutil.copytree(bare.parent / "work", tmp_path / "work")
    again = ["bake", box, "-o", tmp_path / "box.frm", *SMALL, "--work", tmp_path / "work", "--keep", "--report"]
    for _ in range(2):
        good(*again, tmp_path / "report")
        assert names(tmp_path / "report") == FILES
    (tmp_path / "report" / "thesis.txt").write_text("years of work")
    refused(1, "--report|report|other files", *again, tmp_path / "report")
    refused(1, "--report|thesis.txt|not a folder", *again, tmp_path / "report" / "thesis.txt")
    refused(1, "two outputs", *again, tmp_path / "x", "--raw", tmp_path / "x" / "bake.json")
    assert names(tmp_path) == ["box.frm", "report", "work"] and names(tmp_path / "report") == [*FILES, "thesis.txt"]


@needs_matplotlib
def test_the_map_and_its_work_may_lie_in_the_report(good, box, bare, tmp_path):
    out = tmp_path / "report" / "maps" / "box.frm"
    shutil.copytree(bare.parent / "work", tmp_path / "report" / "box.frm.work")
    out.parent.mkdir()
    again = ["bake", box, "-o", out, *SMALL, "--work", tmp_path / "report" / "box.frm.work", "--keep", "--report",
             tmp_path / "report"]
    for _ in range(2):
        good(*again)
        assert names(tmp_path / "report") == sorted([*FILES, "box.frm.work", "maps"])
    assert out.read_bytes() == bare.read_bytes()


def test_without_the_tools_the_map_is_written_all_the_same(frm, box, bare, tmp_path):
    shutil.copytree(bare.parent / "work", tmp_path / "work")
    # A Python that does not start is as good as none.
    outcome = frm("bake", box, "-o", tmp_path / "box.frm", *SMALL, "--work", tmp_path / "work", "--report",
                  tmp_path / "a report", env={**os.environ, "PYTHONHOME": str(tmp_path / "nowhere")})
    assert outcome.status == 1 and str(tmp_path / "box.frm") in outcome.out
    assert (tmp_path / "box.frm").read_bytes() == bare.read_bytes()
    assert names(tmp_path / "a report") == FILES[:2] and names(tmp_path) == ["a report", "box.frm", "work"]
    said = outcome.err.splitlines()
    assert sum("apt install python3-matplotlib" in line for line in said) == 2  # before the work, and after it
    assert "The bake goes on" in outcome.err and said[-1].startswith("frm") and "the map is written" in said[-1]
    if HAS_MATPLOTLIB:
        subprocess.run(said[-1].split("Then: ")[1], shell=True, check=True)
        assert names(tmp_path / "a report") == FILES


@needs_matplotlib
def test_speeds_and_spins_are_in_it(good, box, tmp_path):
    good("bake", box, "-o", tmp_path / "box.frm", *SMALL, "--speeds", "1", "--spin", "--report", tmp_path / "report")
    flows = json.loads((tmp_path / "report" / "bake.json").read_text())["flows"]
    assert {(flow["kind"], flow["speed"] > 0.9) for flow in flows} >= {("stream", False), ("stream", True)}
    spins = [flow for flow in flows if flow["kind"] == "spin"]
    assert spins and all(flow["left_out"] is None and flow["torque_coefficient"] > 0 for flow in spins)
    page = (tmp_path / "report" / "report.html").read_text()
    assert "spin about" in page and "at 1 m/s" in page and page.count("<img ") == 4 + len(flows)
