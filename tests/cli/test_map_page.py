"""The page of scripts/validate-map: what was not run keeps its rows, what was run takes their place."""
from __future__ import annotations

import sys

import pytest
from conftest import ROOT

PAGE = ROOT / "docs" / "validation-map.md"
HEADINGS = ("Bakes", "Directions held out", "Fluctuations there", "Size", "Several speeds", "Spin")


@pytest.fixture(scope="module")
def map_page():
    folders = [str(ROOT / "scripts"), str(ROOT / "scripts" / "lib")]
    sys.path[:0] = folders
    import map_page
    yield map_page
    del sys.path[:2]


def test_a_page_of_nothing_new_keeps_all_rows(map_page):
    before = PAGE.read_text()
    after = map_page.page([], None, None, "commit", "machine", [], [], before)
    for heading in HEADINGS:
        rows = map_page.rows_under(before, heading)
        assert rows and map_page.rows_under(after, heading) == rows, heading
    assert "(commit" not in before and "commit commit, machine" in after


def test_a_first_page_has_empty_tables(map_page):
    after = map_page.page([], None, None, "commit", "machine", [], ["plate-draft"], "")
    assert "Not run: 1 steps, among them plate-draft." in after
    assert all(map_page.rows_under(after, heading) == [] for heading in HEADINGS)


def test_a_new_row_takes_the_place_of_the_old(map_page):
    before = PAGE.read_text()
    rows = [{"reynolds": 500, "several": 1.04, "one": 1.2, "run": 1.0}, {"reynolds": 9000, "several": 1.2, "one": 2, "run": 1}]
    after = map_page.rows_under(map_page.page([], rows, None, "c", "m", [], [], before), "Several speeds")
    old = map_page.rows_under(before, "Several speeds")
    assert [row[0] for row in after] == [row[0] for row in old] + ["9,000"]
    assert after[1] == ["500", "4.0 %", "20.0 %", "yes"] and after[-1][-1] == "**no**"
    assert [row for row in after if row[0] not in ("500", "9,000")] == [row for row in old if row[0] != "500"]


def test_a_table_of_other_columns_starts_anew_and_bakes_keep_their_order(map_page):
    table = map_page.table(("map", "x"), [("rock-draft", 1), ("plate-draft", 2)], [["paddle-draft", "3"], ["gone", "4", "5"]])
    assert [line.split(" | ")[0] for line in table.splitlines()[2:]] == ["| plate-draft", "| paddle-draft", "| rock-draft"]
