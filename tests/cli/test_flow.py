"""frm flow: one short run of the solver."""
import csv
import io
import math

import pytest

SHORT = ["--speed", "0.5", "--resolution", "6", "--start-up", "0.5", "--duration", "1"]
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
    for key in ("area", "reynolds", "cd", "cl", "uncertainty", "seconds"):
        assert math.isfinite(j[key])
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


def test_water_that_is_too_thick_is_refused(refused, box):
    refused(1, "Reynolds", "flow", box, "--direction", "1,0,0", *SHORT, "--viscosity", "100")
