"""scripts/validate-flow with a program that answers at once: what is kept, what is done again, what the page says."""
from __future__ import annotations

import importlib
import json
import math
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import time

import pytest
from conftest import ROOT

pytest.importorskip("matplotlib")

SCRIPT = ROOT / "scripts" / "validate-flow"

# Solves nothing: writes down how it was called, and gives what answers.json has for the words of its command line.
PROGRAM = """#!/usr/bin/python3 -S
import json, os, pathlib, sys, time
here = pathlib.Path(__file__).parent
words = " ".join(sys.argv[1:])
with open(here / ("looks" if "--start-up 0.5 --duration 0.5" in words else "calls"), "a") as calls:
    calls.write(words + "\\n")
if words == "bench --json":
    print(json.dumps({"results": [{"name": "flow_kernel_mlups", "value": 123.4, "unit": "M/s"},
                                  {"name": "wave_200_us", "value": 1, "unit": "us"}]}))
    sys.exit()
assert pathlib.Path(sys.argv[2]).is_file()
result = {"cd": 1.0, "cl": 0.067, "cl_amplitude": 0.333, "strouhal": 0.1, "torque_coefficient": -0.6166, "area": 0.01,
          "uncertainty": 0.02, "uncertainty_parts": {"grid": -1, "statistics": 0.01, "blockage": 0.005},
          "cells": 123456, "steps": 1000, "bytes": 5e7, "mlups": 100, "seconds": 1.5, "ending": "duration"}
for pattern, change in json.loads((here / "answers.json").read_text()).items():
    if all(word in words for word in pattern.split(" & ")):
        if "say" in change:
            print("note: it is thin", file=sys.stderr)
            print(change["say"], file=sys.stderr)
        if "status" in change:
            sys.exit(change["status"])
        if "sleep" in change:
            (here / "pid").write_text(str(os.getpid()))
            time.sleep(change["sleep"])
        result.update(change)
print(json.dumps(result))
"""


@pytest.fixture(scope="module")
def lib():
    """lib("flow_judge"): a module of scripts/lib."""
    sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "scripts" / "lib")]
    yield importlib.import_module
    del sys.path[:2]


class Stub:
    def __init__(self, folder):
        self.folder, self.program, self.out = folder, folder / "frm", folder / "out"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)
        self.answer({})

    def answer(self, answers):
        (self.folder / "answers.json").write_text(json.dumps(answers))

    def command(self, *arguments):
        return [sys.executable, SCRIPT, "--program", self.program, "--out", self.out, "--docs", self.folder / "docs",
                *arguments]

    def run(self, *arguments, status=0):
        done = subprocess.run(self.command(*arguments), capture_output=True, text=True, timeout=100)
        assert done.returncode == status, done.stdout + done.stderr
        return done.stdout + done.stderr

    def calls(self, kind="calls"):
        """What the program has been asked since the last time; "looks": how a case begins."""
        path = self.folder / kind
        lines = path.read_text().splitlines() if path.exists() else []
        path.unlink(missing_ok=True)
        return lines

    def kept(self, name):
        return json.loads((self.out / "cases" / (name + ".json")).read_text())

    @property
    def page(self):
        return (self.folder / "docs" / "validation-flow.md").read_text()


@pytest.fixture
def stub(tmp_path):
    return Stub(tmp_path)


def test_what_is_there_is_kept(stub):
    stub.run("--only", "spin-*")
    assert len(stub.calls()) == 3
    assert stub.kept("spin-200")["result"]["cells"] == 123456
    out = stub.run("--only", "spin-*")
    assert stub.calls() == [] and out.count("kept") == 3

    # What a run that was killed left: a case without a file, and one that was being written.
    (stub.out / "cases" / "spin-50.json").rename(stub.out / "cases" / "spin-50.json.part")
    (stub.out / "cases" / "spin-200.json").write_text('{"name": "spin-')
    stub.run("--only", "spin-*")
    assert [re.search("0,0,[^ ]*", call)[0] for call in stub.calls()] == ["0,0,0.02", "0,0,0.08"]
    assert not list(stub.out.rglob("*.part"))

    stub.run("--only", "spin-*", "--fresh")
    assert len(stub.calls()) == 3


@pytest.mark.parametrize("key", ["command", "mesh_sha256"])
def test_what_was_measured_otherwise_is_measured_again(stub, key):
    stub.run("--only", "spin-200")
    path = stub.out / "cases" / "spin-200.json"
    path.write_text(json.dumps({**stub.kept("spin-200"), key: "another"}))
    assert "not measured" in stub.run("--list", "--only", "spin-200")
    stub.calls()
    stub.run("--only", "spin-200")
    assert len(stub.calls()) == 1 and stub.kept("spin-200")[key] != "another"


def test_other_sources_that_step_alike_are_the_same_solver(stub):
    stub.run("--only", "spin-*")
    assert len(stub.calls()) == 3 and len(stub.calls("looks")) == 3

    def came_from(**changes):
        for name in ("spin-50", "spin-200", "spin-1000"):
            path = stub.out / "cases" / (name + ".json")
            path.write_text(json.dumps({**stub.kept(name), **changes}))

    came_from(solver="another")
    assert stub.run("--list", "--only", "spin-*").count("not measured") == 3  # nothing is run to list
    assert stub.run("--only", "spin-*").count("kept") == 3
    assert stub.calls() == [] and len(stub.calls("looks")) == 3
    stub.run("--only", "spin-*")
    assert stub.calls() == [] and stub.calls("looks") == []  # it is this solver now

    came_from(solver="another")
    stub.answer({"": {"bytes": 6e7, "seconds": 3, "mlups": 50}})  # of this, no number depends
    assert stub.run("--only", "spin-*").count("kept") == 3
    stub.calls("looks")

    came_from(solver="another")
    stub.answer({"0,0,0.08": {"cells": 123457}})  # one of them begins otherwise
    stub.run("--only", "spin-*")
    assert len(stub.calls()) == 1 and stub.kept("spin-200")["result"]["cells"] == 123457
    for changes in ({"reads": "another"}, {"begins": None}):
        came_from(solver="another", **changes)
        stub.run("--only", "spin-*")
        assert len(stub.calls()) == 3
    came_from(solver="another")
    stub.answer({"--duration 0.5 ": {"status": 1}})  # cannot be told
    stub.run("--only", "spin-*")
    assert len(stub.calls()) == 3 and not stub.kept("spin-50")["begins"]


def test_another_machine_goes_on_from_what_the_page_was_made_of(stub):
    stub.run()
    stub.calls(), stub.calls("looks")
    shutil.rmtree(stub.out)
    assert "not measured" not in stub.run("--list")
    assert "kept" in stub.run("--only", "spin-200") and stub.calls() == []
    known = stub.folder / "docs" / "validation-flow.json"
    records = json.loads(known.read_text())
    before = stub.page
    stub.run("--page")
    assert stub.page == before and json.loads(known.read_text()) == records

    # What other sources gave is looked at first, and is not lost where it is not; what has failed is tried again.
    others = {name: {**record, "solver": "another"} for name, record in records.items()}
    known.write_text(json.dumps(others))
    shutil.rmtree(stub.out)
    stub.run("--page")
    assert "not measured" in stub.page and json.loads(known.read_text()) == others
    stub.run("--only", "spin-50")
    assert stub.calls("looks") and stub.kept("spin-50")["solver"] == records["spin-50"]["solver"]
    (stub.out / "cases" / "spin-200.json").write_text(json.dumps({**records["spin-200"], "command": ["old"]}))
    known.write_text(json.dumps(records))
    stub.calls()
    assert "kept" in stub.run("--only", "spin-200") and stub.calls() == []  # not hidden by an older one
    stub.answer({"0,0,0.08": {"status": 1}})
    stub.run("--only", "spin-200", "--fresh")
    stub.run("--page")
    assert "spin-200" not in json.loads(known.read_text()) and "spin-50" in json.loads(known.read_text())
    known.write_text("[]")
    stub.run("--list")


def test_the_solver_is_another_when_its_code_changes(lib, tmp_path):
    runs = lib("flow_runs")
    assert len(runs.solver_sources(ROOT)) > 20
    source = tmp_path / "bake" / "flow" / "kernel.cpp"
    source.parent.mkdir(parents=True)
    source.write_text("int a;\n\n// a comment\nint b;  // at the end\n")
    first = runs.solver_version(tmp_path)
    source.write_text("int a;\n    // another\nint b;  // at the end  \n")
    assert runs.solver_version(tmp_path) == first
    source.write_text("int a;\nint c;  // at the end\n")
    assert runs.solver_version(tmp_path) != first
    source.rename(source.with_name("other.cpp"))
    assert runs.solver_version(tmp_path) != first


def test_a_case_that_fails_is_written_down_and_the_others_go_on(stub):
    stub.answer({"--spin & 0,0,0.02": {"say": "frm flow: --spin: no such option", "status": 2},
                 "--spin & 0,0,0.08": {"cd": float("nan"), "torque_coefficient": None}})
    out = stub.run("--only", "spin-*", "--check", status=1)
    assert "spin-50: exit status 2: frm flow: --spin: no such option" in out
    assert stub.kept("spin-50")["error"] and stub.kept("spin-50")["notes"] == ["it is thin"]
    assert "spin-200: torque_coefficient is not reported" in out
    assert len(stub.calls()) == 3
    stub.answer({})
    stub.run("--only", "spin-*")  # a failed case is tried again, the others are kept
    assert len(stub.calls()) == 1 and "error" not in stub.kept("spin-50")


def test_a_program_that_was_told_to_stop_leaves_nothing(stub):
    stub.answer({"spin": {"ending": "cancelled"}})
    assert "stopped" in stub.run("--only", "spin-50", status=1)
    assert not list(stub.out.glob("cases/*"))


def test_stopped_in_the_middle(stub):
    stub.answer({"0,0,0.08": {"sleep": 50}})
    with subprocess.Popen(stub.command("--only", "spin-*"), stdout=subprocess.PIPE, text=True) as process:
        for _ in range(1000):
            if (stub.folder / "pid").exists() and (stub.folder / "pid").read_text():
                break
            time.sleep(0.01)
        assert "another one is at work" in stub.run("--only", "spin-*", status=1)
        process.send_signal(signal.SIGTERM)
        assert process.wait(20) == 143
    with pytest.raises(ProcessLookupError):  # the program went with it
        os.kill(int((stub.folder / "pid").read_text()), 0)
    assert [path.name for path in stub.out.glob("cases/*")] == ["spin-50.json"]
    stub.answer({})
    stub.calls()
    stub.run("--only", "spin-*")
    assert len(stub.calls()) == 2


def test_a_case_that_does_not_end(stub):
    stub.answer({"0,0,0.08": {"sleep": 50}})
    assert "spin-200: not done after 0.5 s" in stub.run("--only", "spin-200", "--longest", "0.5", "--check", status=1)


def test_only(stub):
    assert len(stub.run("--list", "--only", "sphere-100").splitlines()) == 1
    assert len(stub.run("--list", "--only", "sphere-100*").splitlines()) > 5
    assert len(stub.run("--list", "--only", "turned").splitlines()) == 4
    assert "no case is called 'cone'" in stub.run("--only", "cone", status=1)
    assert 1 < len(stub.run("--list", "--quick").splitlines()) < 10


def test_check_is_about_what_must_be_reached(stub):
    stub.answer({"sphere.glb & --speed 0.001 ": {"cd": 1.087 * 1.029}})
    stub.run("--only", "sphere-100", "--check")
    stub.answer({"sphere.glb & --speed 0.001 ": {"cd": 1.087 * 1.031}})
    assert "NOT reached" in stub.run("--only", "sphere-100", "--check", "--fresh", status=1)
    stub.answer({"sphere.glb & --speed 0.001 ": {"cd": 1.087, "seconds": 61}})
    assert "seconds 61, at most 60" in stub.run("--only", "sphere-100", "--check", "--fresh", status=1)
    stub.answer({"sphere.glb & --speed 0.001 ": {"cd": 1.087}})
    stub.run("--only", "sphere-100", "--check", "--fresh")
    stub.answer({"--turn": {"cd": 1.087 * 1.04}})
    assert "drag changes by +4.0 %" in stub.run("--only", "sphere-100-turned", "--check", status=1)


def test_the_page(stub, lib):
    cases = lib("flow_cases")
    stub.answer({"plate_5.glb": {"say": "frm: out | of memory", "status": 1},
                 "sphere.glb & --speed 0.1 ": {"cd": 0.46},  # 15 % off
                 "cube.glb": {"cd": 1.06}, "cube.glb & --turn": {"cd": 1.08}, "section_0.2.glb": {"ending": "seconds"},
                 **{f"sphere.glb & --speed 0.001 & --resolution {n} ": {"cd": 1.08 + 5 / n ** 1.5}
                    for n in (12, 16, 24, 32, 48)}})
    stub.run()
    assert len(stub.calls()) == len(cases.CASES) + 1
    page = stub.page
    for case in cases.CASES:
        assert f"| {case.name} |" in page and f"# {case.name}\n" in page
    assert "| plate-5 | 10,000 | drag | **failed** | 1.2 | 1.15 to 1.25 | – | 7 %, aim 5 % | **no** |" in page
    assert "- `plate-5`: exit status 1: frm: out \\| of memory" in page
    assert ("| sphere-10000 | 10,000 | drag | 0.46 | 0.4 | 0.385 to 0.42 | +15.0 % | 10 % | **no** | 2.0 % | – | 1.0 % "
            "| 0.5 % | **no** |") in page
    assert "| cube-10000-turned | cube-10000 | 1.06 | 1.08 | +1.9 % | 1.4 % | 3 % | yes |" in page
    assert re.search(r"Order 1\.50, limit 1\.08,", page)
    assert "no order can be told" in page  # the cube's, all alike
    assert "`flow_kernel_mlups` | 123.4 |" in page and "wave_200_us" not in page
    assert "| spin-200 | 200 | torque | 0.6166 | 0.6166 |" in page and str(stub.folder) not in page
    for lines in re.findall(r"(?:^\|.*\n)+", page, re.M):  # as many cells in each row as the table has
        assert len({len(re.findall(r"(?<!\\)\|", row)) for row in lines.splitlines()}) == 1, lines
    picture = (stub.folder / "docs" / "validation-flow.svg").read_bytes()

    # Once more from what is kept: the same bytes, and nothing is run for it but the bench.
    stub.run("--page")
    assert stub.calls() == ["bench --json"]
    assert stub.page == page and (stub.folder / "docs" / "validation-flow.svg").read_bytes() == picture

    # What is gone is not on the page.
    (stub.out / "cases" / "sphere-10000.json").unlink()
    (stub.folder / "docs" / "validation-flow.json").unlink()
    stub.run("--page")
    assert "| sphere-10000 | 10,000 | drag | not measured | 0.4 |" in stub.page


def test_without_results_there_is_a_page_all_the_same(stub):
    stub.run("--page", "--check", status=1)
    assert stub.calls() == ["bench --json"]
    assert re.search(r"\| cases \| 0 of \d+ gave a result \|", stub.page) and "Needs three runs" in stub.page


def test_order_of_convergence(lib):
    fit = lib("flow_judge").convergence
    cells = [12, 16, 24, 32, 48]
    for order in (0.8, 1.0, 2.0, 3.1):
        found = fit(cells, [1.05 - 3 / n ** order for n in cells])
        assert found.order == pytest.approx(order, abs=0.006) and found.limit == pytest.approx(1.05, rel=1e-4)
        assert found.residual < 1e-4 and not found.remark
    three = fit([8, 16, 32], [1 + 1 / n for n in (8, 16, 32)])  # Richardson's own case: exact
    assert three.order == pytest.approx(1) and three.limit == pytest.approx(1)
    noise = fit(cells, [1.0, 1.01, 0.99, 1.01, 1.0], [0.01] * 5)
    assert noise.order is None and noise.limit == pytest.approx(1.002) and "no order" in noise.remark
    rough = fit(cells, [1.2, 1.0, 1.2, 1.0, 1.05])
    assert rough.order is None or "far from the fit" in rough.remark
    assert fit([12, 16], [1, 2]).limit is None


def test_honesty(lib):
    judge, cases = lib("flow_judge"), lib("flow_cases")
    known = cases.Reference(1.0, 0.97, 1.03, "", "seen")
    assert judge.is_honest(1.04, known, 0.02) and judge.is_honest(0.97, known, 0.0)
    assert not judge.is_honest(1.04, known, 0.01)
    assert judge.is_honest(1.049, known, 0.019) and not judge.is_honest(1.051, known, 0.019)  # the root of squares
    assert judge.stated({"result": {"uncertainty": 0.03}}).grid is None  # a program that does not tell the parts


def test_the_table_is_consistent(lib):
    cases = lib("flow_cases")
    names = [case.name for case in cases.CASES]
    assert len(set(names)) == len(names)
    for case in cases.CASES:
        for target in case.targets:
            assert target.at_most or cases.reference(case, target).low <= cases.reference(case, target).value
        if case.like:
            assert case.like in names and case.percent > 0
            other = next(one for one in cases.CASES if one.name == case.like)
            words = case.command()
            at = words.index("--turn")
            assert words[:at] + words[at + 2:] == other.command()  # nothing else differs
    for known in cases.REFERENCES.values():
        assert known.low <= known.value <= known.high and known.checked in cases.CHECKED
    assert all(name in names for series in cases.SERIES.values() for name in series)
    command = next(case for case in cases.CASES if case.name == "sphere-100").command()
    assert command[command.index("--speed") + 1] == "0.001" and command[-1] == "--json"


def test_facets_do_not_matter(lib):
    cases = lib("flow_cases")
    for mesh in (body.make() for body in cases.BODIES.values()):
        assert struct.unpack("<I", mesh.glb()[8:12])[0] == len(mesh.glb())  # closed and outward, or it would not be
    ball = cases.sphere(0.1)
    assert ball.volume() == pytest.approx(math.pi / 6 * 1e-3, rel=1e-4)
    corners = [math.hypot(*corner) for corner in ball.vertices]
    assert max(corners) == pytest.approx(0.05, rel=1e-3) and min(corners) == pytest.approx(0.05, rel=1e-3)
    rod = cases.cylinder(0.1, 0.4)
    assert rod.volume() == pytest.approx(math.pi / 4 * 0.01 * 0.4, rel=1e-4)
    assert max(math.hypot(x, y) for x, y, _ in rod.vertices) == pytest.approx(0.05, rel=1e-3)
    plate = cases.BODIES["box_8_1_30"].make()  # of the samples
    assert plate.volume() == pytest.approx(0.08 * 0.01 * 0.3)
