"""frm run and frm replay on small scenes."""
import csv
import importlib.util
import json
import os
import signal
import subprocess

import pytest

from conftest import PROGRAM, names

PARTS = ("", "buoyancy_", "pressure_", "friction_", "gravity_")


def read_csv(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_record_and_replay(good, scene, tmp_path):
    path = scene()
    outcome = good("run", path, "--record", tmp_path / "a b.frmrec")
    assert "150 ticks" in outcome.out and "world hash" in outcome.out and "a b.frmrec" in outcome.out
    assert names(tmp_path) == ["a b.frmrec", "box.frm", "scene.json"]
    assert "150 ticks" in good("replay", tmp_path / "a b.frmrec").out
    j = good("replay", tmp_path / "a b.frmrec", "--json").json
    assert j["identical"] is True and j["ticks"] == j["replayed"] == 150 and j["torn"] is False
    verified = good("verify", tmp_path / "a b.frmrec", "--json").json
    assert verified["kind"] == "recording" and verified["ticks"] == 150 and verified["sound"] is True


def test_json_and_the_same_hash_from_run_to_run(good, scene):
    first, again = (good("run", scene(), "--json").json for _ in range(2))
    assert first["world_hash"] == again["world_hash"]
    assert first["ticks"] == 150 and first["seconds"] == pytest.approx(0.3) and first["scene"] == "Small"
    assert first["bodies"][0]["peak_force"] > 0
    assert sum(first["tick_us"]["histogram"]["counts"]) == 150
    assert good("run", scene(), "--json", "--seconds", "0.1").json["world_hash"] != first["world_hash"]


def test_csv(good, scene, tmp_path):
    body = {"map": "box", "name": "other", "motion": {"type": "fixed", "position": [0, 0, 5]}, "mass": 2}
    path = scene()
    j = json.loads(path.read_text())
    j["bodies"].append(body)
    path.write_text(json.dumps(j))
    good("run", path, "--csv", tmp_path / "out.csv", "--seconds", "0.02")
    rows = read_csv(tmp_path / "out.csv")
    components = ("fx", "fy", "fz", "tx", "ty", "tz")
    assert list(rows[0]) == ["time", "body"] + [part + c for part in PARTS for c in components]
    assert [row["body"] for row in rows] == ["box", "other"] * 10
    assert float(rows[-1]["time"]) == pytest.approx(0.018)
    for row in rows:
        parts = sum(float(row[part + "fz"]) for part in PARTS[1:])
        assert float(row["fz"]) == pytest.approx(parts, rel=1e-5, abs=1e-5)
    assert float(rows[1]["fz"]) == pytest.approx(-2 * 9.80665, rel=1e-6) and float(rows[1]["buoyancy_fz"]) == 0


def test_similarity(good, scene, tmp_path):
    """Twice the speed through deep water, ticks of half the length: the same instants of the map's series."""
    parts = []
    for name, speed, dt in (("slow.csv", 0.5, 0.002), ("fast.csv", 1, 0.001)):
        path = scene(dt=dt, seconds=100 * dt, world={"surface": "none"}, water=None,
                     body={"motion": {"type": "steady", "velocity": [speed, 0, 0]}})
        good("run", path, "--csv", tmp_path / name)
        parts.append(read_csv(tmp_path / name))
    for slow, fast in zip(*parts):
        assert float(slow["buoyancy_fz"]) == 0
        assert float(fast["pressure_fx"]) == pytest.approx(4 * float(slow["pressure_fx"]), rel=2e-6)
        assert float(fast["friction_fx"]) == pytest.approx(2 * float(slow["friction_fx"]), rel=2e-6)


def test_a_map_on_the_command_line_wins(good, refused, scene, map_path, tmp_path):
    path = scene(maps=None)
    good("run", path, "--map", f"box={map_path}", "--seconds", "0.01")
    refused(1, "bodies[0].map|--map box=FILE", "run", path)
    refused(1, "--map|box", "run", path, "--map", "box")
    refused(1, "nowhere.frm", "run", scene(), "--map", "box=nowhere.frm")
    refused(1, "scene.json", "run", path, "--map", f"box={path}")
    refused(1, "--map foo=nowhere.frm|no body|scene.json", "run", scene(), "--map", "foo=nowhere.frm")


@pytest.mark.parametrize("words, changes", [
    (".sekonds|not known", {"sekonds": 1}),
    (".water.size|not known", {"water": {"size": 3}}),
    (".water", {"water": {"nx": 4, "ny": 4}}),
    (".water.nx|whole", {"water": {"nx": 20.5}}),
    (".water.border|absorbing", {"water": {"border": "soft"}}),
    (".water: an object", {"water": 3}),
    (".world", {"world": {"gravity": -1}, "water": None}),
    (".world.density|too large", {"world": {"density": 1e300}}),
    (".world.model|paper", {"world": {"model": "mine"}}),
    (".dt", {"dt": 0}), (".dt", {"dt": 1}), (".seconds", {"seconds": None}), (".seconds", {"seconds": -1}),
    (".title", {"title": 4}),
    ("1e9 ticks", {"seconds": 1e12}),
    (".bodies", {"bodies": None}), (".bodies[0]", {"bodies": [3]}),
    (".maps.box", {"maps": {"box": 5}}), ("missing.frm", {"maps": {"box": "missing.frm"}}),
    (".bodies[0].map", {"body": {"map": "sphere"}}),
    (".bodies[0].name", {"body": {"name": "a,b"}}),
    (".bodies[0]|mass", {"body": {"mass": -1}}),
    (".bodies[0].mass|too large", {"body": {"mass": 1e300}}),
    (".bodies[0]|scale", {"body": {"scale": 0}}),
    (".bodies[0].centre_of_mass|three", {"body": {"centre_of_mass": [1, 2]}}),
    (".bodies[0].motion", {"body": {"motion": 3}}),
    (".motion.type|steady", {"body": {"motion": {"type": "fast"}}}),
    (".motion.type", {"body": {"motion": {"type": 3}}}),
    (".motion.velocity|not known", {"body": {"motion": {"type": "fixed", "velocity": [1, 0, 0]}}}),
    (".motion.velocity|three", {"body": {"motion": {"type": "steady", "velocity": [1, 0]}}}),
    (".bodies[0]|linear", {"body": {"motion": {"type": "steady", "velocity": [1e6, 0, 0]}}}),
    (".motion.position|1e9", {"body": {"motion": {"type": "fixed", "position": [1e12, 0, 0]}}}),
    (".motion.keys|two", {"body": {"motion": {"type": "keyframes", "keys": [{"time": 0}]}}}),
    (".motion.keys[1].time|later", {"body": {"motion": {"type": "keyframes", "keys": [{"time": 1}, {"time": 0}]}}}),
    (".motion.keys[1].place|not known",
     {"body": {"motion": {"type": "keyframes", "keys": [{"time": 1}, {"time": 2, "place": 0}]}}}),
    (".motion.repeat|true or false",
     {"body": {"motion": {"type": "keyframes", "repeat": 1, "keys": [{"time": 1}, {"time": 2}]}}}),
    (".motion.device", {"body": {"motion": {"type": "device"}}}),
    (".motion.device|no.frmrec", {"body": {"motion": {"type": "device", "device": "no.frmrec"}}}),
])
def test_what_is_wrong_is_named_and_nothing_is_left(refused, scene, tmp_path, words, changes):
    path = scene(**changes)
    words = "scene.json|" + words if words.startswith(".") else words
    refused(1, words, "run", path, "--record", "r.frmrec", "--csv", "r.csv", cwd=tmp_path)
    assert names(tmp_path) == ["box.frm", "scene.json"]


@pytest.mark.parametrize("text", ["", "{", "[]", '{"seconds": 1e999}', "null"])
def test_not_a_scene(refused, tmp_path, text):
    (tmp_path / "scene.json").write_text(text)
    line = refused(1, "scene.json", "run", tmp_path / "scene.json")
    assert "json.exception" not in line


def test_a_run_that_fails_half_way_leaves_nothing(refused, scene, tmp_path):
    # Between 0.2 s and 0.2001 s the body goes a kilometre.
    keys = [{"time": 0}, {"time": 0.2}, {"time": 0.2001, "position": [1000, 0, 0]}]
    path = scene(body={"motion": {"type": "keyframes", "keys": keys}})
    (tmp_path / "r.frmrec").write_text("older")
    refused(1, "bodies[0]|t = 0.2 s|linear", "run", path, "--record", tmp_path / "r.frmrec", "--json",
            "--csv", tmp_path / "r.csv")
    assert names(tmp_path) == ["box.frm", "r.frmrec", "scene.json"] and (tmp_path / "r.frmrec").read_text() == "older"


def test_inputs_are_not_overwritten(refused, scene, tmp_path):
    path = scene()
    for option in ("--record", "--csv"):
        for target in (path, tmp_path / "box.frm"):
            refused(1, f"{target.name}|another file", "run", path, option, target)
    refused(1, "x|two outputs", "run", path, "--record", tmp_path / "x", "--csv", tmp_path / "x")
    refused(1, "nowhere/x", "run", path, "--record", tmp_path / "nowhere" / "x")
    assert names(tmp_path) == ["box.frm", "scene.json"]


def test_devices(good, refused, scene, tmp_path):
    still = scene(body={"motion": {"type": "device", "device": "null"}})
    good("run", still, "--record", tmp_path / "first.frmrec")
    assert good("replay", tmp_path / "first.frmrec", "--json").json["identical"]
    again = scene(body={"motion": {"type": "device", "device": str(tmp_path / "first.frmrec")}})
    good("run", again, "--record", tmp_path / "second.frmrec", "--json")
    assert good("replay", tmp_path / "second.frmrec", "--json").json["identical"]
    # The recording has 150 exchanges.
    refused(1, "bodies[0]|t = 0.3 s", "run", again, "--seconds", "0.4", "--record", tmp_path / "third.frmrec")
    assert not list(tmp_path.glob("third*"))
    moving = scene()
    good("run", moving, "--record", tmp_path / "moving.frmrec")
    without = scene(body={"motion": {"type": "device", "device": str(tmp_path / "moving.frmrec")}})
    refused(1, "motion.device", "run", without)


def test_an_interrupted_recording_is_kept(good, scene, tmp_path):
    path = scene(seconds=10000)
    process = subprocess.Popen([PROGRAM, "run", str(path), "--record", str(tmp_path / "r.frmrec"),
                                "--csv", str(tmp_path / "r.csv")], text=True, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE)
    line = process.stderr.readline()
    assert line.startswith("run: ") and "left" in line and "%" in line
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=100)
    assert process.returncode == 1 and "interrupted after" in err
    j = good("replay", tmp_path / "r.frmrec", "--json").json
    assert j["identical"] and not j["torn"] and j["ticks"] == len(read_csv(tmp_path / "r.csv"))
    assert names(tmp_path) == ["box.frm", "r.csv", "r.frmrec", "scene.json"]


def test_a_recording_whose_process_died_is_replayed_to_the_cut(good, scene, tmp_path):
    process = subprocess.Popen([PROGRAM, "run", str(scene(seconds=10000)), "--record", str(tmp_path / "r.frmrec")],
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    process.stderr.readline()
    process.kill()
    process.communicate(timeout=100)
    j = good("replay", tmp_path / "r.frmrec.part", "--json").json
    assert j["torn"] and j["identical"] and j["ticks"] > 64


def test_a_recording_that_was_cut(good, scene, tmp_path):
    good("run", scene(), "--record", tmp_path / "r.frmrec")
    whole = (tmp_path / "r.frmrec").read_bytes()
    (tmp_path / "cut.frmrec").write_bytes(whole[:-len(whole) // 4])
    assert "cut off" in good("verify", tmp_path / "cut.frmrec").out
    j = good("replay", tmp_path / "cut.frmrec", "--json").json
    assert j["torn"] and j["identical"] and 20 <= j["ticks"] < 150


def test_a_damaged_recording(refused, scene, good, tmp_path):
    good("run", scene(), "--record", tmp_path / "r.frmrec")
    data = bytearray((tmp_path / "r.frmrec").read_bytes())
    data[len(data) // 2] ^= 1
    (tmp_path / "bad.frmrec").write_bytes(data)
    refused(1, "bad.frmrec", "verify", tmp_path / "bad.frmrec")
    refused(1, "bad.frmrec", "replay", tmp_path / "bad.frmrec")


def test_a_terminal_gets_a_bar(scene):
    ours, theirs = os.openpty()
    process = subprocess.Popen([PROGRAM, "run", str(scene(seconds=10000))], stdout=subprocess.DEVNULL, stderr=theirs)
    os.close(theirs)
    text = os.read(ours, 200).decode()
    process.kill()
    process.wait()
    os.close(ours)
    assert "\r\x1b[Krun [" in text and "%" in text and "left" in text


@pytest.mark.skipif(importlib.util.find_spec("matplotlib") is None, reason="matplotlib is not there")
def test_report(good, refused, scene, tmp_path):
    outcome = good("run", scene(seconds=0.1), "--report", tmp_path / "the report", "--json")
    assert outcome.json["ticks"] == 50  # and nothing but JSON on standard output
    assert names(tmp_path / "the report") == ["report.html", "run.frmrec", "run.json"]
    page = (tmp_path / "the report" / "report.html").read_text()
    assert "<html" in page and "http-equiv=\"refresh\"" not in page
    assert json.loads((tmp_path / "the report" / "run.json").read_text()) == outcome.json
    (tmp_path / "file").write_text("")
    refused(1, "file", "run", scene(), "--report", tmp_path / "file")


def test_presets_are_other_cells_for_the_same_water(good, refused, scene, tmp_path):
    water = {"nx": 48, "ny": 40, "cell": 0.025, "border_cells": 8}

    def hash_of(path, *more):
        return good("run", path, "--json", *more).json["world_hash"]
    plain = hash_of(scene(water=water))
    assert hash_of(scene(preset="default", water=water)) == plain
    fast = hash_of(scene(water={**water, "nx": 24, "ny": 20, "cell": 0.05, "border_cells": 4}))
    accurate = hash_of(scene(water={**water, "order": 4}))
    assert len({plain, fast, accurate}) == 3
    assert hash_of(scene(preset="fast", water=water)) == fast and hash_of(scene(preset="accurate", water=water)) == accurate
    # The command line goes before the file; what the file says of the order stays where the preset says nothing.
    assert hash_of(scene(preset="fast", water=water), "--preset", "accurate") == accurate
    assert hash_of(scene(preset="fast", water=water), "--preset", "default") == plain
    assert hash_of(scene(preset="default", water={**water, "order": 4})) == accurate
    # Without water there is nothing that a preset changes.
    assert hash_of(scene(water=None, preset="fast")) == hash_of(scene(water=None))


def test_a_preset_that_is_none(refused, scene):
    refused(1, "scene.json.preset|quick|fast, default, accurate", "run", scene(preset="quick"))
    refused(1, "scene.json.preset|text", "run", scene(preset=2))
    refused(2, "--preset", "run", scene(), "--preset", "quick")
