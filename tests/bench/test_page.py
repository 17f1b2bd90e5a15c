"""The page that scripts/performance writes, from quick runs."""
from __future__ import annotations

import re
import subprocess
import sys

import pytest

from conftest import PROGRAM, ROOT

SCENES = ("waves", "buoyancy", "buoyancy-waves", "tow", "crowd", "stroke", "boat")


@pytest.fixture(scope="module")
def drawn(measured):
    pytest.importorskip("matplotlib")
    import performance_page
    records = {scene: {"result": measured(scene), "commit": "0" * 12, "machine": "one", "load": 1.0, "seconds": 60} for scene in SCENES}
    return records, *performance_page.page(records, True)


def test_page_has_every_setting(drawn):
    records, text, plots = drawn
    assert text.startswith("# Run time against error\n") and "--quick" in text
    for name in SCENES:
        for row in records[name]["result"]["scenes"][0]["rows"]:
            assert f"| {row['knob']} | " in text and row["label"] in text
    assert sorted(re.findall(r"\]\((performance-[a-z]+)\.svg\)", text)) == sorted(plots)
    assert "nan" not in text and "None" not in text


def test_plots_are_the_same_bytes_every_time(drawn):
    plots = drawn[2]
    for draw in plots.values():
        first = draw("svg")
        assert first.startswith(b"<?xml") and first == draw("svg")
        assert b"time" in first and b"error of the" in first
        assert not re.search(rb"<dc:date>", first)


def test_knee_is_judged_by_both():
    import performance_page
    judge = performance_page.verdict
    assert judge(0.5, 3, 2, 0.8) == "yes"  # half the time for three times the error; twice the time for a fifth less
    assert judge(0.5, 1.1, 2, 0.9) == "coarser pays"
    assert judge(0.9, 2, 1.1, 0.3) == "finer pays"
    assert judge(0.99, 1.01, 1.0, 0.98) == "no matter"
    assert judge(None, None, 2, 0.9) == "yes"
    assert judge(0.98, 1.5, None, None) == "yes"


@pytest.mark.full
def test_script_goes_on_where_it_was(tmp_path):
    """Two bakes and all scenes; the second time nothing is left to do, and the page is the same."""
    def run(*more):
        done = subprocess.run([sys.executable, "-B", str(ROOT / "scripts" / "performance"), "--quick", "--program", PROGRAM,
                               "--out", str(tmp_path / "out"), "--docs", str(tmp_path / "docs"), *more], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout
    assert run().count("bench frontier") == len(SCENES) + 1
    page = (tmp_path / "docs" / "performance.md").read_text()
    assert "MuJoCo" in page and (tmp_path / "docs" / "performance-maps.svg").is_file()
    assert "bench frontier" not in run()
    assert (tmp_path / "docs" / "performance.md").read_text() == page
