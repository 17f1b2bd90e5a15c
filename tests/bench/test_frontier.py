"""frm bench frontier: what it compares is compared rightly. Nothing here looks at how long anything took."""
from __future__ import annotations

import json
import math
import os

import pytest

PLAYED = ("stroke", "boat", "tow", "crowd", "waves")
SCENES = (*PLAYED, "buoyancy", "buoyancy-waves")
OF = {"waves": "height"}


def errors(rows, against, of="force", measure="rms"):
    return [row["error"][against][of][measure] for row in rows]


@pytest.mark.parametrize("scene", SCENES)
def test_says_what_it_promises(measured, scene):
    answer = measured(scene)
    assert answer["version"] == 1 and answer["repeats"] == 2 and answer["quick"] is True
    table, = answer["scenes"]
    assert set(table) == {"scene", "what", "reference", "error_of", "peak_force", "peak_torque", "rows"}
    assert table["what"] and table["error_of"] == OF.get(scene, "force")
    for row in table["rows"]:
        assert set(row) - {"map_bytes"} == {"knob", "label", "value", "default", "peer", "dt", "tick_us", "us_at_500_hz", "ratio",
                                            "ratio_quartiles", "frontier", "error"}
        low, high = row["ratio_quartiles"]
        assert 0 < low <= row["ratio"] <= high and math.isfinite(high)
        assert row["tick_us"] > 0 and row["us_at_500_hz"] == pytest.approx(row["tick_us"] * 0.002 / row["dt"])
        assert row["error"] and set(row["error"]) <= {"exact", "finest", "knob_finest"}
        for kind in row["error"].values():
            for one in kind.values():
                assert set(one) == {"rms", "worst"} and all(math.isfinite(v) and v >= 0 for v in one.values())
                if table["error_of"] == "force":
                    assert one["rms"] <= one["worst"] * (1 + 1e-9)


@pytest.mark.parametrize("scene", SCENES)
def test_has_its_defaults(table, scene):
    rows = [row for row in table(scene)["rows"] if not row["peer"]]
    knobs = {row["knob"] for row in rows}
    defaults = [row["knob"] for row in rows if row["default"]]
    assert len(defaults) == len(set(defaults)) and defaults
    # Order 4 and no waiting have the default's cells, but are not the default.
    assert {knob for knob in knobs if not knob.startswith("cell, order")} <= set(defaults)
    if scene in PLAYED:
        for row in rows:
            if row["default"]:
                assert row["ratio"] == 1 and row["ratio_quartiles"] == [1, 1]


@pytest.mark.parametrize("scene", SCENES)
def test_frontier_is_what_nothing_beats(table, scene):
    of = table(scene)["error_of"]
    points = []
    for row in table(scene)["rows"]:
        if not row["peer"]:
            kind = "exact" if "exact" in row["error"] else "finest"
            points.append((row["us_at_500_hz"], row["error"][kind][of]["rms"], row["frontier"]))
    for time, error, best in points:
        beaten = any(t <= 1.03 * time and e <= 1.03 * error and (1.03 * t < time or 1.03 * e < error) for t, e, _ in points)
        assert best == (not beaten)
    assert any(best for *_, best in points)


@pytest.mark.parametrize("scene", ("stroke", "tow"))
@pytest.mark.parametrize("name", ("sources", "directions", "map precision"))
def test_finer_maps_are_nearer_to_the_finest(knob, scene, name):
    off = errors(knob(scene, name), "knob_finest")
    assert off[-1] == 0
    assert all(finer < coarser for coarser, finer in zip(off, off[1:])), off
    assert off[-2] < 0.1  # the default


@pytest.mark.parametrize("scene, name", (("stroke", "cell"), ("stroke", "tick"), ("boat", "triangles"), ("boat", "tick")))
def test_finer_steps_are_nearer_to_the_finest(knob, scene, name):
    off = errors(knob(scene, name), "knob_finest")
    assert len(off) > 2 and off[-1] == 0 and all(finer < coarser for coarser, finer in zip(off, off[1:])) and off[-2] < 0.1, off


def test_waves_meet_the_exact_answer(knob):
    second = errors(knob("waves", "cell, order 2"), "exact", "height")
    fourth = errors(knob("waves", "cell, order 4"), "exact", "height")
    assert second == sorted(second, reverse=True) and fourth == sorted(fourth, reverse=True)
    # The waves of 64 cells. Second order in space: the phase after 5.5 lengths is off by 2 pi 5.5 (pi / 64)^2 / 6 = 1.4 % at most.
    assert second[-1] < 0.02 and fourth[-1] < 0.02
    # Sixteen cells a wave, four times coarser: sixteen times as far off by the second order.
    assert 8 < second[1] / second[-1] < 24
    assert fourth[1] < 0.3 * second[1]


def test_buoyancy_meets_the_exact_answer(knob):
    rows = knob("buoyancy", "triangles")
    off = errors(rows, "exact")
    # The volume between an ellipsoid and its chords goes with the area of a triangle.
    for coarser, finer in zip(rows, rows[1:]):
        ratio = coarser["error"]["exact"]["force"]["rms"] / finer["error"]["exact"]["force"]["rms"]
        assert ratio == pytest.approx(finer["value"] / coarser["value"], rel=0.35)
    assert off[-1] < 0.004


@pytest.mark.parametrize("way", ("points counted", "points smoothed"))
def test_points_come_nearer_with_their_number(knob, way):
    off = errors(knob("buoyancy", way), "exact")
    assert off == sorted(off, reverse=True)
    # Even a thousand points are farther off than 2,048 triangles.
    assert off[-1] > errors(knob("buoyancy", "triangles"), "exact")[-1]
    assert off[-1] < 0.1


def test_budgets_are_kept(table):
    """What docs/model.md promises of the error budget, of the force on any body at any time."""
    for scene in ("tow", "crowd"):
        rows = [row for row in table(scene)["rows"] if row["knob"] == "error budget"]
        budgets = [row["value"] for row in rows]
        assert budgets[-1] == 0 and max(budgets) > 1
        for row in rows:
            # One newton in a million for the numbers' own rounding.
            allowed = row["value"] / table(scene)["peak_force"] * 1.1 + 1e-6
            assert row["error"]["knob_finest"]["force"]["worst"] <= allowed


def test_skips_cost_what_is_allowed(table):
    for scene in ("stroke", "boat", "tow"):
        skips = [row for row in table(scene)["rows"] if row["knob"] == "skip"]
        assert skips[0]["label"] == "all" and skips[-1]["label"] == "nothing"
        # 0.1 % for waiting in waves of 32 cells (docs/model.md, section 7).
        assert errors(skips[:1], "knob_finest")[0] < 0.005


def test_errors_are_the_same_every_time(frm, measured):
    again = frm("bench", "frontier", "--quick", "--repeats", 1, "--scene", "tow", "--json")
    first, second = measured("tow")["scenes"][0], json.loads(again.stdout)["scenes"][0]
    assert [row["error"] for row in first["rows"]] == [row["error"] for row in second["rows"]]


def test_maps_are_compared_with_the_last(table):
    map_path = os.environ.get("FRM_TEST_MAP")
    if not map_path:
        pytest.skip("FRM_TEST_MAP is not set")
    rows = table("maps", "--map", map_path, "--map", map_path)["rows"]
    own = [row for row in rows if row["knob"] == "map"]
    assert len(own) == 2 and all(error == 0 for error in errors(own, "knob_finest"))
    budgets = [row for row in rows if row["knob"] == "time budget"]
    assert errors(budgets, "knob_finest")[-1] == 0 < errors(budgets, "knob_finest")[0]
    for row in (row for row in rows if row["peer"]):  # where MuJoCo is installed
        assert row["knob"] == "MuJoCo" and row["error"]["knob_finest"]["force"]["rms"] > 0


@pytest.mark.parametrize("words, status, says", (
    (("frontier", "--scene", "nowhere"), 2, "--scene"),
    (("frontier", "--scene", "maps"), 1, "--map"),
    (("frontier", "--scene", "maps", "--map", "none.frm", "--map", "none.frm"), 1, "none.frm"),
    (("frontier", "--repeats", "0"), 2, "--repeats"),
    (("--json", "frontier"), 2, "--json: belongs after frontier"),
))
def test_refuses(frm, words, status, says):
    done = frm("bench", *words)
    assert done.returncode == status and says in done.stderr and done.stdout == ""


def test_text_has_every_row(frm):
    done = frm("bench", "frontier", "--quick", "--repeats", 1, "--scene", "buoyancy")
    assert done.returncode == 0
    assert done.stdout.count("triangles") >= 3 and "points smoothed" in done.stdout and "default" in done.stdout
