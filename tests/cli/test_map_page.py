"""The page of scripts/validate-map: what was not run keeps its rows, what was run takes their place."""
from __future__ import annotations

import subprocess
import sys

import pytest
from conftest import ROOT

HEADINGS = ("Bakes", "Directions held out", "Fluctuations there", "Size", "Several speeds", "Spin")


@pytest.fixture(scope="module")
def map_page():
    sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "scripts" / "lib")]
    import map_page
    yield map_page
    del sys.path[:2]


def made(map_page, name, *, rms=0.05, swing=(0.1, 0.1, 5)):
    """What validate-map gathers of a bake, with one direction held out."""
    held = {"map": {"force_mean": [1 + rms, 0, 0], "force_rms": [0.1, 0, 0]}, "swing": swing,
            "run": {"force_mean": [1, 0, 0], "uncertainty": 0.01}}
    return {"bake": next(bake for bake in map_page.BAKES if bake.name == name), "peak": 1.0, "held": [held], "raw_bytes": 5e5,
            "made": {"seconds": 30, "version": "0123456789", "result": {"file_bytes": 5e4}}, "verified": {"quantisation_error": 0.004},
            "info": {"provenance": {"directions": [0] * 15, "period_lengths": 8}, "sources": 24, "quantisation_error": 0.004,
                     "direction_error_rms": 0.06, "direction_error_worst": 0.1}}


SPEEDS = [{"reynolds": 500, "several": 1.04, "one": 1.2, "run": 1.0}, {"reynolds": 150, "several": 1.2, "one": 2, "run": 1}]
SPIN = [{"axis": "x", "with": 1.01, "without": 0.5, "run": 1.0, "uncertainty": 0.01}]


def page(map_page, bakes=(), speeds=None, spin=None, before=""):
    return map_page.page(list(bakes), speeds, spin, "c0ffee", "machine", ["0123456789"], before)


def rows(map_page, text, heading):
    return [map_page.cells(line) for line in map_page.lines_under(text, heading)[2:]]


@pytest.fixture
def before(map_page):
    return page(map_page, [made(map_page, "rock-draft"), made(map_page, "plate-draft")], SPEEDS, SPIN)


def test_a_page_of_nothing_new_keeps_all_rows(map_page, before):
    after = page(map_page, before=before)
    for heading in HEADINGS:
        assert rows(map_page, before, heading), heading
        assert map_page.lines_under(after, heading) == map_page.lines_under(before, heading), heading
    assert [row[0] for row in rows(map_page, after, "Bakes")] == ["plate-draft", "rock-draft"]  # in the order of the table
    assert "Not run: paddle-draft, plate-standard" in after and "rock-draft in directions" not in after


def test_a_first_page_has_empty_tables(map_page):
    assert not any(rows(map_page, page(map_page), heading) for heading in HEADINGS)


def test_what_is_run_takes_the_place_of_its_rows(map_page, before):
    after = page(map_page, [made(map_page, "plate-draft", rms=0.02)], [{"reynolds": 500, "several": 1.1, "one": 1.2, "run": 1.0}],
                 before=before)
    held = {row[0]: row[1] for row in rows(map_page, after, "Directions held out")}
    assert held == {"plate-draft": "2.0 %", "rock-draft": "5.0 %"}
    assert rows(map_page, after, "Several speeds") == [["500", "10.0 %", "20.0 %", "**no**"]]
    assert rows(map_page, after, "Spin") == rows(map_page, before, "Spin")
    # A map that was baked anew and not asked has no row of the map that there was.
    unasked = {**made(map_page, "plate-draft"), "held": []}
    after = page(map_page, [unasked], before=before)
    assert [row[0] for row in rows(map_page, after, "Directions held out")] == ["rock-draft"]


def test_rows_of_another_table_and_of_what_is_no_more_go(map_page, before):
    other = before.replace("| stated rms |", "| said rms |").replace("| rock-draft |", "| stone-draft |")
    after = page(map_page, before=other)
    assert rows(map_page, after, "Directions held out") == []
    assert [row[0] for row in rows(map_page, after, "Bakes")] == ["plate-draft"]


def test_a_part_that_there_is_not(tmp_path):
    done = subprocess.run([sys.executable, ROOT / "scripts" / "validate-map", "--page", "--only", "plate-drft", "--program",
                           sys.executable, "--out", tmp_path / "out", "--docs", tmp_path], capture_output=True, text=True)
    assert done.returncode == 1 and "no part is called 'plate-drft'; there are plate-draft, " in done.stderr
    assert not (tmp_path / "validation-map.md").exists()
