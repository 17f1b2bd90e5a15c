"""The page of a recording: whole, on its own, and with the numbers of the recording."""
from __future__ import annotations

import base64
import io
import json
import os
import re
import shutil
import subprocess
import sys

import pytest
from conftest import ROOT

import frm

numpy = pytest.importorskip("numpy")
pytest.importorskip("matplotlib")

from frm import _page, _progress, _words, report  # noqa: E402 - after the skips

TICKS, DT = 150, 0.002


def run_summary(path, **changes) -> dict:
    edges = numpy.geomspace(10, 1000, 41)
    times = numpy.linspace(40, 90, TICKS)
    return {"scene": "stroke <of> a box", "ticks": TICKS, "dt": DT, "seconds": 0.5, "recording": str(path),
            "command": "frm run stroke.json",
            "tick_us": {"median": 65.0, "p99": 89.5, "p9999": 90.0, "max": 90.0, "mean": 65.0,
                        "histogram": {"edges_us": edges.tolist(),
                                      "counts": numpy.histogram(times, edges)[0].tolist()}}, **changes}


def make(recording, tmp_path, run=None, arguments=("--frames", "2")) -> str:
    output = tmp_path / "report.html"
    if run is not None:
        (tmp_path / "run.json").write_text(json.dumps(run))
        arguments = [*arguments, "--run", str(tmp_path / "run.json")]
    assert report.main([str(recording), "-o", str(output), *arguments]) == 0
    return output.read_text(encoding="utf-8")


def without_pictures(page: str) -> str:
    return re.sub(r'src="data:[^"]*"', 'src=""', page)


def text_of(page: str) -> str:
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", "", without_pictures(page)))


def test_page(record, tmp_path):
    path, totals = record(TICKS, DT)
    page = make(path, tmp_path, run_summary(path), ["--frames", "6"])

    assert not re.search(r"https?:|<script|<link|@import|url\(", without_pictures(page))
    assert all(source.startswith("data:image/") for source in re.findall(r'src="([^"]*)"', page))
    # The view from the side, three figures of the body, the colour bar, the frames and the histogram.
    assert len(re.findall("<img ", page)) == 1 + 3 + 1 + 6 + 1
    assert len(re.findall(r'<img [^>]*alt="[^"]+"', page)) == len(re.findall("<img ", page))
    for kind, data in re.findall(r'src="data:image/([a-z+]+);base64,([^"]*)"', page):
        start = base64.b64decode(data)[:64]
        assert start.startswith(b"\x89PNG" if kind == "png" else b"<?xml")

    text = text_of(page)
    assert f"replayed {TICKS} ticks: identical" in text
    assert "stroke &lt;of&gt; a box" in text
    sizes = numpy.linalg.norm(numpy.array(totals, numpy.float32), axis=1)
    peak = int(sizes.argmax())
    size, when = _words.number(float(sizes[peak])), _words.number(DT * (peak + 1))
    assert f"The force peaks at {size} N after {when} s" in text
    impulse = _words.vector(numpy.sum(numpy.array(totals) * DT, axis=0))
    assert f"its impulse over the run is {impulse} N s" in text
    assert "Half of the 150 ticks took less than 65 µs" in text
    with frm.Context() as context, frm.Replay(context, path) as replay:
        info = replay.map(0).info()
    for name in info.field_names():
        assert _page._MAP_FIELDS[name][0] in text
    assert f"{info.content_hash:016x}" in text


def test_svg_is_well_formed(record, tmp_path):
    from xml.etree import ElementTree
    page = make(record(40)[0], tmp_path)
    pictures = re.findall(r'src="data:image/svg\+xml;base64,([^"]*)"', page)
    assert pictures
    for data in pictures:
        ElementTree.parse(io.BytesIO(base64.b64decode(data)))


def test_same_recording_same_page(record, tmp_path):
    path, _ = record(60)
    assert make(path, tmp_path) == make(path, tmp_path)


def test_without_a_run_there_is_no_histogram(record, tmp_path):
    page = make(record(40)[0], tmp_path)
    assert "Time of a tick" not in page and "stroke" in page


def test_run_of_another_recording_is_noted(record, tmp_path):
    path, _ = record(40)
    assert "may not belong together" in make(path, tmp_path, run_summary(path))


def test_water_without_a_body(context, tmp_path):
    path = tmp_path / "water.rec"
    world = frm.World(context)
    with frm.Recorder(world, path):
        frm.Water(world, nx=32, ny=16, border_cells=2).set_height([0.01] * 16 + [0.0] * (32 * 16 - 16))
        for _ in range(30):
            world.tick(DT)
    text = text_of(make(path, tmp_path, arguments=["--frames", "3"]))
    assert "replayed 30 ticks: identical" in text and "Water surface" in text
    assert "Force and torque" not in text


def test_body_without_water(context, map_path, tmp_path):
    path = tmp_path / "air.rec"
    world = frm.World(context)
    with frm.Recorder(world, path):
        frm.Body(world, frm.Map(context, map_path), pose=((0, 0, 50), (0, 0, 0, 1)))
        for _ in range(10):
            world.tick(DT)
    text = text_of(make(path, tmp_path))
    assert "did not touch the water" in text and "Water surface" not in text


def test_bodies_that_come_and_go(context, map_path, tmp_path):
    path = tmp_path / "two.rec"
    world = frm.World(context)
    map = frm.Map(context, map_path)
    with frm.Recorder(world, path):
        first = frm.Body(world, map)
        for tick in range(40):
            if tick == 10:
                frm.Body(world, map, pose=((2, 0, 0), (0, 0, 0, 1)))
            if tick == 30:
                first.close()
            world.tick(DT)
    text = text_of(make(path, tmp_path))
    assert "replayed 40 ticks: identical" in text
    assert "Body 0: force and torque" in text and "Body 1: force and torque" in text
    assert text.count("It was there for 30 of 40 ticks.") == 2


def test_first_difference_is_told(record, tmp_path, monkeypatch):
    path, _ = record(30)
    step = frm.Replay.step

    def differs(self):
        result = step(self)
        if result.tick in (7, 9):
            result.diverged, result.part = 1, frm.PART_PRESSURE if result.tick == 7 else frm.PART_WORLD
        return result
    monkeypatch.setattr(frm.Replay, "step", differs)
    text = text_of(make(path, tmp_path))
    assert "replayed 30 ticks: 2 ticks differ; first tick 7, in the pressure of body 0" in text
    assert "identical" not in text


def test_torn_recording(context, tmp_path):
    world = frm.World(context)
    recorder = frm.Recorder(world, tmp_path / "torn.rec")
    for _ in range(200):
        world.tick(DT)
    torn = tmp_path / "copy.rec"
    shutil.copy(tmp_path / "torn.rec.part", torn)
    recorder.close()
    assert "The recording was cut off" in text_of(make(torn, tmp_path))


def test_no_ticks(context, tmp_path):
    path = tmp_path / "empty.rec"
    frm.Recorder(frm.World(context), path).close()
    assert "replayed 0 ticks: identical" in text_of(make(path, tmp_path))


def command(*arguments, **environment):
    return subprocess.run([sys.executable, "-m", "frm.report", *map(str, arguments)], capture_output=True,
                          text=True,
                          env={**os.environ, "PYTHONPATH": str(ROOT / "bindings/python"), **environment})


def test_missing_recording(library, tmp_path):
    done = command(tmp_path / "none.rec", "-o", tmp_path / "r.html")
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and "none.rec" in done.stderr
    assert not list(tmp_path.iterdir())


def test_bad_recording(library, tmp_path):
    bad = tmp_path / "bad.rec"
    bad.write_bytes(b"nothing of the kind " * 50)
    done = command(bad, "-o", tmp_path / "r.html")
    assert done.returncode == 1 and done.stderr.startswith("frm.report: ") and done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == [bad]


def test_failed_write_leaves_nothing(record, tmp_path, monkeypatch):
    path, _ = record(20)
    before = sorted(tmp_path.iterdir())

    def fail(*_):
        raise OSError(28, "No space left on device", "r.html")
    monkeypatch.setattr(os, "replace", fail)
    assert report.main([str(path), "-o", str(tmp_path / "r.html")]) == 1
    assert sorted(tmp_path.iterdir()) == before


def test_bad_run(record, tmp_path):
    path, _ = record(20)
    run = tmp_path / "run.json"
    for content, word in (("{", "JSON"), ("[]", "object"), ('{"tick_us": {"median": 1}}', "p99")):
        run.write_text(content)
        done = command(path, "-o", tmp_path / "r.html", "--run", run)
        assert done.returncode == 1 and word in done.stderr and done.stderr.count("\n") == 1
    assert command(path, "--run", tmp_path / "none.json").returncode == 1


def test_missing_matplotlib(tmp_path):
    script = ("import sys, importlib.util as u; find = u.find_spec\n"
              "u.find_spec = lambda name, *a: None if name == 'matplotlib' else find(name, *a)\n"
              "from frm import report; sys.exit(report.main(['x.rec']))")
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=tmp_path,
                          env={**os.environ, "PYTHONPATH": str(ROOT / "bindings/python")})
    assert done.returncode == 1 and "apt install python3-matplotlib" in done.stderr


@pytest.mark.parametrize("value, text", [
    (0, "0"), (12.3456, "12.3"), (-0.5, "−0.5"), (1500, "1 500"), (1e-6, "1 × 10⁻⁶"), (-2.5e9, "−2.5 × 10⁹"),
    (999999.5, "1 000 000"), (300469.2, "300 000"), (float("nan"), "–")])
def test_numbers(value, text):
    assert _words.number(value).replace("\u202f", " ") == text


def test_progress(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(_progress.time, "monotonic", lambda: now[0])
    lines = io.StringIO()
    with _progress.Progress("replaying", 100, lines) as progress:
        for done in range(101):
            now[0] = done * 0.1
            progress(done)
    assert 3 <= lines.getvalue().count("\n") <= 6 and "s left" in lines.getvalue()

    class Terminal(io.StringIO):
        def isatty(self):
            return True
    terminal = Terminal()
    now[0] = 0.0
    with _progress.Progress("replaying", 100, terminal) as progress:
        for done in range(101):
            now[0] = done * 0.1
            progress(done)
    assert "[####" in terminal.getvalue() and terminal.getvalue().endswith("\r\x1b[K")
    short = io.StringIO()
    now[0] = 0.0
    with _progress.Progress("replaying", 100, short) as progress:
        progress(100)
    assert short.getvalue() == ""
