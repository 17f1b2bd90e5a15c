"""The page of a flow: from what frm flow --report leaves, made up here, with the numbers that are in it."""
from __future__ import annotations

import json
import math
import re

import pytest

numpy = pytest.importorskip("numpy")
pytest.importorskip("matplotlib")

from frm import _flow, _flow_figures, flow_report  # noqa: E402 - after the skips
from test_report import text_of  # noqa: E402

STROUHAL, INTERVAL, SPEED, LENGTH = 0.2, 0.02, 0.5, 0.25
LIFT = 0.3  # its amplitude as a coefficient


def write(folder, samples=1000, slices=2, parts=None, **changes):
    """A wake that sheds, in files. `changes` go to the JSON, those of "report" to what is there."""
    parts = parts or {"grid": 0.03, "statistics": 0.01, "blockage": 0.002}
    unit = 0.5 * 1000 * SPEED ** 2 * 0.06
    time = INTERVAL * numpy.arange(samples)
    phase = 2 * math.pi * STROUHAL * SPEED / LENGTH * time
    rows = numpy.zeros((samples, 13))
    rows[:, 0], rows[:, 1], rows[:, 3] = time, -unit * 1.1, unit * LIFT * numpy.sin(phase)
    rows[:, 10] = 0.004
    numpy.savetxt(folder / "series.csv", rows, delimiter=",", header="time,...", comments="")
    x = numpy.linspace(-1, 3, 81)
    y = numpy.linspace(-1, 1, 41)
    speed = numpy.ones((41, 81), "<f4")
    speed[numpy.hypot(*numpy.meshgrid(x, y)) < 0.12] = numpy.nan
    with open(folder / "slices.f32", "wb") as file:
        for _ in range(slices):
            speed.tofile(file)
            (0 * speed - 0.5).tofile(file)
    report = {"format": _flow.FORMAT, "mesh": "<a> box.glb", "notes": ["1 < 2 cells"], "direction": [-1, 0, 0],
              "speed": SPEED, "viscosity": 1e-6, "density": 1000.0, "resolution": 16, "start_up": 10, "duration": 40,
              "section": False, "slab": 0, "spin": [0, 0, 0], "axes": [[-1, 0, 0], [0, 1, 0], [0, 0, 1]],
              "reference_length": LENGTH, "fastest": SPEED, "travelled": 40.0, "lift_axis": [0, 0, 1],
              "slices": [{"normal": 1 + n, "low": [-1, -n, n - 1], "spacing": 0.05, "columns": 81, "rows": 41,
                          "offset": 2 * n * speed.size} for n in range(slices)], **changes.pop("report", {})}
    blocks = [{"low": [-0.3 * s, -0.2 * s, -0.2 * s], "high": [0.5 * s, 0.2 * s, 0.2 * s], "cell": 0.0125 * s,
               "cells": 1000 * s} for s in (1, 2, 4)]
    flow = {"force_mean": [-8.25, 0, 0], "area": 0.06, "length": LENGTH, "reynolds": 125000.0,
            "reynolds_solved": 125000.0, "cd": 1.1, "cd_coarse": 1.2, "cl_amplitude": LIFT, "strouhal": STROUHAL,
            "torque_coefficient": None, "uncertainty": 0.0317, "uncertainty_parts": parts, "ending": "duration",
            "samples": samples, "interval": INTERVAL, "blockage": 0.01, "bytes": 2 ** 26, "blocks": blocks,
            "cells": 7000, "steps": 4000, "mlups": 50.0, "seconds": 12.0, **changes, "report": report}
    (folder / "flow.json").write_text(json.dumps(flow))


def make(folder) -> str:
    assert flow_report.main([str(folder)]) == 0
    return (folder / "report.html").read_text(encoding="utf-8")


def test_page(tmp_path):
    write(tmp_path)
    page = make(tmp_path)
    assert not re.search(r"https?:|<script|<link|@import|url\(", re.sub(r'src="data:[^"]*"', "", page))
    # Uncertainty, series, spectrum, two slices and the grid.
    assert len(re.findall(r'<img src="data:image/[^"]*" alt="[^"]+"', page)) == 6 == page.count("<img ")
    text = text_of(page)
    for words in ("&lt;a&gt; box.glb", "The drag coefficient is 1.1 ± 3.2 %", "1 &lt; 2 cells",
                  "Strouhal number of 0.2, which 8 periods tell poorly", "coefficient is 1.2 where this one",
                  "The grid is the largest part, 3 %",
                  "--resolution 32", "16 times as long", "8 such periods", "3 blocks with 7 000 cells"):
        assert words in text
    assert "interrupted" not in text


def test_the_spectrum_has_its_peak_where_the_lift_swings(tmp_path):
    write(tmp_path)
    flow = _flow.read(tmp_path)
    lift = flow.coefficients["lift"]
    strouhal, size = _flow_figures.amplitudes(flow, lift)
    assert strouhal[size.argmax()] == pytest.approx(STROUHAL, rel=0.02)
    assert size.max() == pytest.approx(LIFT, rel=0.02)
    assert flow.coefficients["drag"] == pytest.approx(1.1)
    assert flow.travelled[-1] == pytest.approx(999 * INTERVAL * SPEED / LENGTH)


def test_what_is_not_known_is_said(tmp_path):
    write(tmp_path, samples=300, parts={"grid": None, "statistics": 0.04, "blockage": 0.001}, cd_coarse=None,
          reynolds_solved=50000.0, ending="cancelled", report={"travelled": 12.0})
    text = text_of(make(tmp_path))
    for words in ("not measured", "leave out --no-grid-error", "--duration 48 --confidence 2", "was interrupted",
                  "carry a Reynolds number of 50 000", "2.4 periods tell poorly"):
        assert words in text


def test_spin_alone_has_a_torque_and_no_drag(tmp_path):
    none = dict.fromkeys(("cd", "cd_coarse", "cl_amplitude", "strouhal"))
    write(tmp_path, **none, torque_coefficient=0.05,
          report={"speed": 0, "spin": [2, 0, 0], "lift_axis": [0, 0, 0], "fastest": 0.2})
    page = make(tmp_path)
    text = text_of(page)
    assert "The torque coefficient is 0.05 ± 3.2 %" in text and "Drag" not in text
    assert "The torque is 0.004 N m in the mean" in text and page.count("<img ") == 5


def test_a_steady_flow_without_slices(tmp_path):
    write(tmp_path, slices=0, strouhal=None)
    page = make(tmp_path)
    assert "No frequency stands out" in text_of(page) and page.count("<img ") == 3


@pytest.mark.parametrize("words, spoil", [
    ("flow.json|not JSON", lambda folder: (folder / "flow.json").write_text("{")),
    ("flow.json|format", lambda folder: (folder / "flow.json").write_text("{}")),
    ("lacks blocks", lambda folder: (folder / "flow.json").write_text(
        json.dumps({k: v for k, v in json.loads((folder / "flow.json").read_text()).items() if k != "blocks"}))),
    ("flow.json|No such file", lambda folder: (folder / "flow.json").unlink()),
    ("series.csv|13 columns", lambda folder: (folder / "series.csv").write_text("a\n1,2\n")),
    ("slices.f32|short", lambda folder: (folder / "slices.f32").write_bytes(b"1234"))])
def test_bad_inputs_are_named_and_leave_nothing(tmp_path, capsys, words, spoil):
    write(tmp_path)
    spoil(tmp_path)
    assert flow_report.main([str(tmp_path)]) == 1
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1 and all(word in error for word in words.split("|"))
    assert not [path for path in tmp_path.iterdir() if "report" in path.name]
