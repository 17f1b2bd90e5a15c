"""Help that teaches, and wrong arguments: status 2, one line that names the argument, nothing on standard output."""
import subprocess

import pytest

from conftest import PROGRAM

OPTIONS = {
    "bake": ["MESH", "--out", "--quality", "draft|standard|high", "--speed", "--directions", "--sources",
             "--resolution", "--threads", "--density", "--viscosity", "--json"],
    "mesh": ["MESH", "--out", "--regions", "--json"],
    "info": ["FILE", "--json"],
    "verify": ["FILE", "--json", "--against"],
    "flow": ["MESH", "--direction", "--speed", "--viscosity", "--density", "--section", "--length",
             "--resolution", "--duration", "--confidence PERCENT", "--seconds", "--spin", "--slab", "--turn DEGREES",
             "--no-grid-error", "--memory GIB", "--report DIR", "--out", "--json"],
    "force": ["FILE", "--velocity", "--spin", "--seconds", "--json"],
    "run": ["SCENE", "--map", "--preset fast|default|accurate", "--record", "--report", "--csv", "--seconds", "--json"],
    "replay": ["FILE", "--json"],
    "bench": ["--seconds", "--full", "--json", "frontier"],
}
FLOW = ["flow", "a.glb", "--direction", "1,0,0", "--speed", "1"]


def test_help_lists_the_commands(good):
    text = good("--help").out
    for command in OPTIONS:
        assert f"\n  {command} " in text
    assert "Exit status" in text


@pytest.mark.parametrize("command", OPTIONS)
def test_help_of_a_command(good, command):
    outcome = good(command, "--help")
    assert outcome.err == ""
    for option in OPTIONS[command]:
        assert option in outcome.out
    for raw in ("ENUM", "->", "FLOAT", "TEXT", "UINT"):
        assert raw not in outcome.out
    assert max(map(len, outcome.out.splitlines())) <= 130


def test_version(good):
    assert good("--version").out.count(".") == 2


@pytest.mark.parametrize("words, arguments", [
    ("a command is needed|--help", []),
    ("bkae|no such command", ["bkae"]),
    ("--foo|no such option", ["--foo"]),
    ("MESH", ["bake"]),
    ("--out", ["bake", "plan", "a.glb"]),
    ("--spede|no such option", ["bake", "a.glb", "-o", "b.frm", "--spede", "1"]),
    ("--direcshun|no such option", ["flow", "a.glb", "--direcshun", "1,0,0", "--speed", "1"]),
    ("more.frm|not expected", ["info", "a.frm", "more.frm"]),
    ("extra|not expected", ["bench", "extra"]),
    ("--velocity", ["force", "a.frm"]),
    ("--velocity", ["force", "a.frm", "--velocity"]),
    ("--velocity|1,2|three numbers", ["force", "a.frm", "--velocity", "1,2"]),
    ("--velocity|three numbers", ["force", "a.frm", "--velocity", "1,2,3,4"]),
    ("--velocity|three numbers", ["force", "a.frm", "--velocity", "1,nan,3"]),
    ("--velocity|three numbers", ["force", "a.frm", "--velocity", ""]),
    ("--velocity|longer than 10000", ["force", "a.frm", "--velocity", "1e30,0,0"]),
    ("--velocity|zero", ["force", "a.frm", "--velocity", "0,0,0"]),
    ("--velocity", ["force", "a.frm", "--velocity", "1,0,0", "--velocity", "2,0,0"]),
    ("--seconds|nan", ["force", "a.frm", "--velocity", "1,0,0", "--seconds", "nan"]),
    ("--seconds|abc", ["force", "a.frm", "--velocity", "1,0,0", "--seconds", "abc"]),
    ("--scale|-1", ["force", "a.frm", "--velocity", "1,0,0", "--scale", "-1"]),
    ("--density|inf", ["force", "a.frm", "--velocity", "1,0,0", "--density", "inf"]),
    ("--direction|no direction", ["flow", "a.glb", "--direction", "0,0,0", "--speed", "1"]),
    ("--speed|-1", ["flow", "a.glb", "--direction", "1,0,0", "--speed", "-1"]),
    ("--speed|0", ["flow", "a.glb", "--direction", "1,0,0", "--speed", "0"]),
    ("--speed|nan", ["flow", "a.glb", "--direction", "1,0,0", "--speed", "nan"]),
    ("--confidence|0|0.1 to 100", [*FLOW, "--confidence", "0"]),
    ("--confidence|1%", [*FLOW, "--confidence", "1%"]),
    ("--seconds|-1", [*FLOW, "--seconds", "-1"]),
    ("--seconds|soon", [*FLOW, "--seconds", "soon"]),
    ("--spin|three numbers", [*FLOW, "--spin", "3"]),
    ("--spin|zero", [*FLOW, "--spin", "0,0,0"]),
    ("--spin|longer than", [*FLOW, "--spin", "0,1e9,0"]),
    ("--slab|--section", [*FLOW, "--slab", "2"]),
    ("--slab|0.1 to 100", [*FLOW, "--section", "--slab", "0"]),
    ("--turn|400", [*FLOW, "--turn", "400"]),
    ("--memory|0", [*FLOW, "--memory", "0"]),
    ("--no-grid-error", [*FLOW, "--no-grid-error=maybe"]),
    ("--report|empty", [*FLOW, "--report", ""]),
    ("--length|-2", ["flow", "a.glb", "--direction", "1,0,0", "--speed", "1", "--length", "-2"]),
    ("--section|no direction", ["flow", "a.glb", "--direction", "1,0,0", "--speed", "1", "--section", "0,0,0"]),
    ("--quality|fast|draft, standard, high", ["bake", "a.glb", "-o", "b.frm", "--quality", "fast"]),
    ("--speed|-1", ["bake", "a.glb", "-o", "b.frm", "--speed", "-1"]),
    ("--speed|nan", ["bake", "a.glb", "-o", "b.frm", "--speed", "nan"]),
    ("--sources|0|4096", ["bake", "a.glb", "-o", "b.frm", "--sources", "0"]),
    ("--sources|5000|4096", ["bake", "a.glb", "-o", "b.frm", "--sources", "5000"]),
    ("--sources|-3", ["bake", "a.glb", "-o", "b.frm", "--sources", "-3"]),
    ("--sources|2.5", ["bake", "a.glb", "-o", "b.frm", "--sources", "2.5"]),
    ("--directions|0", ["bake", "a.glb", "-o", "b.frm", "--directions", "0"]),
    ("--resolution|1e9|512", ["bake", "a.glb", "-o", "b.frm", "--resolution", "1e9"]),
    ("--resolution|nan", ["bake", "a.glb", "-o", "b.frm", "--resolution", "nan"]),
    ("--threads|-1", ["bake", "a.glb", "-o", "b.frm", "--threads", "-1"]),
    ("--jsonn|no such option", ["mesh", "a.glb", "--jsonn"]),
    ("MESH", ["mesh"]),
    ("--record|empty", ["run", "a.json", "--record", ""]),
    ("FILE|empty", ["info", ""]),
    ("--seconds|0", ["run", "a.json", "--seconds", "0"]),
    ("--seconds|inf", ["bench", "--seconds", "inf"]),
])
def test_wrong_arguments(refused, words, arguments, tmp_path):
    refused(2, words, *arguments, cwd=tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("arguments", [
    ["info", "no.frm"], ["verify", "no.frm"], ["force", "no.frm", "--velocity", "1,0,0"], ["run", "no.frm"],
    ["replay", "no.frm"], ["mesh", "no.frm"], ["bake", "no.frm", "-o", "b.frm"],
    ["flow", "no.frm", "--direction", "1,0,0", "--speed", "1"]])
def test_a_file_that_is_not_there(refused, arguments, tmp_path):
    refused(1, "no.frm", *arguments, cwd=tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_full_disk_is_a_failure(frm, map_path):
    with open("/dev/full", "w") as full:
        done = subprocess.run([PROGRAM, "info", str(map_path)], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 1 and "standard output" in done.stderr
