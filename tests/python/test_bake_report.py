"""The page of a bake: from what frm bake --report leaves, made up here, with the numbers that are in it."""
from __future__ import annotations

import json
import math
import re

import pytest

numpy = pytest.importorskip("numpy")
pytest.importorskip("matplotlib")

from frm import _bake, _bake_figures, _bake_page, bake_report  # noqa: E402 - after the skips
from test_report import text_of  # noqa: E402

SPEED, LENGTH, INTERVAL, SAMPLES, AREA = 0.5, 0.25, 0.01, 800, 0.06
UNIT = 0.5 * 1000 * SPEED ** 2 * AREA  # N, of a coefficient
STROUHAL = 0.2
SIDES = numpy.array([(-1, 0, 0), (0, -1, 0), (0, 0, -1), (0, 0, 1), (0, 1, 0), (1, 0, 0)], float)  # in their order
FACES = [(x, y, z) for x in (0, 5) for y in (1, 4) for z in (2, 3)]


class Data:
    def __init__(self):
        self.values = numpy.zeros(0)

    def add(self, rows):
        rows = numpy.asarray(rows, float)
        described = {"offset": len(self.values), "shape": list(rows.shape)}
        self.values = numpy.concatenate([self.values, rows.ravel()])
        return described


def flow_of(data, number, direction, **changes):
    """The force along the stream 1.1 + number / 10 as a coefficient, and a wake that sheds across it."""
    across = numpy.roll(direction, 1)
    time = INTERVAL * numpy.arange(SAMPLES)
    swing = 0.3 * numpy.sin(2 * math.pi * STROUHAL * SPEED / LENGTH * time)
    force = UNIT * (numpy.outer(numpy.full(SAMPLES, 1.1 + number / 10), direction) + numpy.outer(swing, across))
    speed = numpy.ones((21, 41))
    speed[9:12, 10:13] = speed[:, 40] = numpy.nan
    return {"name": f"direction {number}", "kind": "stream", "direction": list(direction), "speed": SPEED,
            "fastest": SPEED, "left_out": 0.02 * (number + 1), "lift_axis": list(across), "cd": 1.1 + number / 10,
            "strouhal": STROUHAL, "torque_coefficient": None, "uncertainty": 0.031,
            "uncertainty_parts": {"grid": None, "statistics": 0.03, "blockage": 0.0078}, "samples": SAMPLES,
            "interval": INTERVAL, "cells": 250000, "seconds": 12.0, "area": AREA, "length": LENGTH,
            "reference_length": LENGTH, "reynolds": 125000.0, "reynolds_solved": 125000.0,
            "axes": [list(direction), list(across), list(numpy.cross(direction, across))],
            "images": data.add([direction, [-c for c in direction]]),
            "series": data.add(numpy.hstack([force, 0.004 + 0 * force])),
            "slice": {**data.add(speed), "normal": 2, "low": [-1, -0.5, 0], "spacing": 0.05}, **changes}


def write(folder, flows=3, errors=None, budgets=None, changes=None, **others):
    """A map of an octahedron, of forces 10 N along the stream and 20 N along y. `changes`: to every flow."""
    data = Data()
    lattice = _bake.Lattice(2)
    directions = lattice.points / numpy.linalg.norm(lattice.points, axis=1)[:, None]
    phase = 2 * math.pi * numpy.arange(20) / 20
    # In step but for ±y, a quarter of the period late.
    swings = [numpy.outer(numpy.sin(phase - (math.pi / 2 if abs(e[1]) else 0)), (0.2, 0, 0)) for e in SIDES]
    j = {"format": _bake.FORMAT, "mesh": "meshes/<a> box.glb", "mesh_hash": "0123", "notes": ["1 < 2 cells"],
         "seconds": 20.0,
         "options": {"quality": "standard", "scale": 1, "speed": SPEED, "speeds": [SPEED], "spin": False,
                     "density": 1000.0, "viscosity": 1e-6, "directions": 0, "sources": 0, "resolution": 24, "symmetry": True,
                     "added_mass": True, "threshold": 2e-4, "start_up": 10, "period": 20, "overlap": 5,
                     "harmonics": 40},
         "body": {"low": [-0.1] * 3, "high": [0.1] * 3, "centroid": [0, 0, 0], "area": 0.07, "volume": 1.3e-3,
                  "triangles": 8, "sources": 2, "patches": 8, "symmetry": "48 elements"},
         "map": {"file": "a box.frm", "bytes": 31200, "directions": 18, "frequency": 2, "fluctuation_directions": 6,
                 "fluctuation_frequency": 1, "samples": 20, "period": 10.0, "reference_length": LENGTH,
                 "reynolds": 125000.0, "reynolds_solved": 125000.0, "spin_rate": 0,
                 "added_mass": list(numpy.diag([1.5, 1.5, 1.5, 0.01, 0.01, 0.01]).ravel())},
         "errors": {"direction_rms": 0.043, "direction_worst": 0.06, "rounding": 0.0041, "uncertainty": 0.031,
                    "added_mass": 0.004, "regions": 0.029, "wet_ratio": 0.02, "velocity": 0.015, "arm": 0.01,
                    **(errors or {})},
         "budgets": {"direction_rms": 0.06, "direction_worst": 0.15, "rounding": 0.005, "uncertainty": 0.1,
                     "regions": 0.03, **(budgets or {})},
         "surface": {"vertices": data.add(0.1 * SIDES), "triangles": data.add(FACES),
                     "region_begin": data.add([[0], [4], [8]]), "sources": data.add([(-0.03, 0, 0, -1, 0, 0), (0.03, 0, 0, 1, 0, 0)])},
         "means": data.add(numpy.hstack([directions, directions * (10 + 10 * directions[:, 1:2] ** 2)])),
         "fluctuation_directions": data.add(SIDES), "fluctuations": data.add(numpy.concatenate(swings)),
         "fluctuation_faces": data.add(FACES),
         "flows": [flow_of(data, n, SIDES[n % 6], **(changes or {})) for n in range(flows)], **others}
    data.values.astype("<f4").tofile(folder / "bake.f32")
    (folder / "bake.json").write_text(json.dumps(j), encoding="utf-8")


def make(folder):
    assert bake_report.main([str(folder)]) == 0
    return (folder / "report.html").read_text(encoding="utf-8")


def test_page(tmp_path):
    write(tmp_path)
    page = make(tmp_path)
    assert not re.search(r"https?:|<script|<link|@import|url\(", re.sub(r'src="data:[^"]*"', "", page))
    # Body, directions, fluctuations, the key of the slices, three flows.
    assert len(re.findall(r'<img src="data:image/[^"]*" alt="[^"]+"', page)) == 7 == page.count("<img ")
    text = text_of(page)
    for words in ("&lt;a&gt; box.glb", "1 &lt; 2 cells", "off by about 4.3 % of the largest (at worst 6 %)",
                  "Within all that standard quality asks; a warning below", "2 haptic regions", "31.2 kB", "20 N",
                  "The drag goes from 10 N towards", "makes the force known in 6. The map has it in 18",
                  "3 flows took 36 s", "towards (−1.00, 0, 0) · drag coefficient 1.1 ± 3.1 % or more",
                  "3.2 periods of shedding", "statistics 3 %, far field 0.78 %", "48 elements", "0.4 %"):
        assert words in text, words
    assert "left out:" not in text and "Not within" not in text


def test_what_is_not_reached_is_said(tmp_path):
    write(tmp_path, errors={"direction_worst": 0.2, "uncertainty": 0.12}, changes={"reynolds_solved": 50000.0})
    text = text_of(make(tmp_path))
    for words in ("Not within what was asked: between directions, worst, the flows&#x27; mean drag",
                  "4.3 % rms and 20 % at worst, not the 6 % and 15 % of this quality", "uncertain by 12 %",
                  "In 3 of 3 flows the cells do not carry the Reynolds number: 50 000 was solved for 125 000"):
        assert words in text, words


def test_a_draft_asks_nothing_of_its_directions(tmp_path):
    write(tmp_path, budgets={"direction_rms": None, "direction_worst": None}, notes=[], errors={"added_mass": None})
    text = text_of(make(tmp_path))
    assert "Nothing was asked of its directions; the rest is within" in text and "warning" not in text
    assert "nothing was asked" in text and "(left out)" in text


def test_of_very_many_flows_the_worst_are_shown(tmp_path, monkeypatch):
    monkeypatch.setattr(_bake_page, "MOST_FLOWS", 4)
    write(tmp_path, flows=7)
    bake = _bake.read(tmp_path)
    assert _bake_page.shown(bake) == [3, 4, 5, 6]
    page = make(tmp_path)
    assert page.count("<img ") == 8 and "3 of 7 flows are left out" in text_of(page)


def test_a_spin_has_a_torque_and_no_drag(tmp_path):
    write(tmp_path, flows=2)
    path = tmp_path / "bake.json"
    j = json.loads(path.read_text())
    j["flows"][1].update(kind="spin", speed=2.0, cd=None, strouhal=None, left_out=None, torque_coefficient=0.05,
                         lift_axis=[0, 0, 0])
    path.write_text(json.dumps(j))
    text = text_of(make(tmp_path))
    assert "spin about (0, −1.00, 0) · torque coefficient 0.05 ± 3.1 % or more" in text and "2 rad/s" in text
    bake = _bake.read(tmp_path)
    assert bake.flow(bake.flows[1]).coefficients["torque"] == pytest.approx(-0.004) and len(bake.base) == 1


def test_the_map_between_its_directions():
    lattice = _bake.Lattice(3)
    assert len(lattice.points) == 38
    values = numpy.random.default_rng(1).normal(size=38)
    assert lattice.interpolate(lattice.points, values) == pytest.approx(values)
    # What is linear on the octahedron is met exactly between its points.
    e = numpy.random.default_rng(2).normal(size=(500, 3))
    assert lattice.interpolate(e, lattice.points @ (1, 2, 3)) == pytest.approx(
        3 * e @ (1, 2, 3) / numpy.abs(e).sum(1))


def test_the_picture_of_the_sphere_is_mollweides():
    e = numpy.random.default_rng(3).normal(size=(200, 3))
    e /= numpy.linalg.norm(e, axis=1)[:, None]
    assert _bake_figures.unmollweide(*_bake_figures.mollweide(e)) == pytest.approx(e, abs=1e-6)
    x, y = _bake_figures.mollweide(numpy.array([(1, 0, 0), (0, 1, 0), (0, 0, 1)]))
    assert x == pytest.approx([0, math.sqrt(2), 0], abs=1e-4) and y == pytest.approx([0, 0, math.sqrt(2)], abs=1e-4)
    assert numpy.isnan(_bake_figures.unmollweide(numpy.array([2.8]), numpy.array([1.0]))).any()


def test_the_slice_ends_where_the_grid_does(tmp_path):
    write(tmp_path)
    bake = _bake.read(tmp_path)
    slice_ = bake.flow(bake.flows[0]).slices[0]
    assert slice_.speed.shape == (21, 40) and slice_.body == pytest.approx([-0.1, 0.1, -0.1, 0.1])  # of the mesh


def test_neighbours_are_in_step_or_not(tmp_path):
    write(tmp_path)
    bake = _bake.read(tmp_path)
    assert bake.rms == pytest.approx(0.2 / math.sqrt(2))
    pairs, step = bake.neighbours
    assert len(pairs) == 12
    late = ((pairs == 1) | (pairs == 4)).any(1)
    assert step[late] == pytest.approx(0, abs=1e-6) and step[~late] == pytest.approx(1)


def test_the_error_of_a_mean():
    noise = numpy.random.default_rng(4).normal(size=20000)
    assert _bake.standard_error(noise) == pytest.approx(1 / math.sqrt(20000), rel=1.5)
    assert _bake.standard_error(numpy.r_[numpy.zeros(500), numpy.ones(500)]) == pytest.approx(0.5)  # of two halves
    counts, means, errors = _bake.running(noise)
    assert counts[-1] == 20000 and means[-1] == pytest.approx(noise.mean())
    assert errors[-1] == _bake.standard_error(noise)


def test_views_are_right_handed_and_show_the_face():
    for _, right, up, eye in _bake_figures.views(numpy.array([-1, -0.1, -3]), numpy.array([1, 0.1, 3])):
        assert numpy.cross(right, up) == pytest.approx(eye)
    face = _bake_figures.views(numpy.array([-1, -0.1, -3]), numpy.array([1, 0.1, 3]))[0]
    assert face[0] == "from +y" and list(face[1]) == [0, 0, 1]


@pytest.mark.parametrize("words, spoil", [
    ("bake.json|not JSON", lambda folder: (folder / "bake.json").write_text("{")),
    ("bake.json|format", lambda folder: (folder / "bake.json").write_text("[]")),
    ("lacks budgets", lambda folder: (folder / "bake.json").write_text(
        json.dumps({k: v for k, v in json.loads((folder / "bake.json").read_text()).items() if k != "budgets"}))),
    ("bake.json|No such file", lambda folder: (folder / "bake.json").unlink()),
    ("bake.f32|short", lambda folder: (folder / "bake.f32").write_bytes(b"1234"))])
def test_bad_inputs_are_named_and_leave_nothing(tmp_path, capsys, words, spoil):
    write(tmp_path)
    spoil(tmp_path)
    assert bake_report.main([str(tmp_path)]) == 1
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1 and all(word in error for word in words.split("|"))
    assert not [path for path in tmp_path.iterdir() if "report" in path.name]
