"""frm servo: a scene in real time. Nothing here says how long anything takes."""
import csv
import json

from conftest import ROOT

DEVICE = {"motion": {"type": "device", "device": "null"}}


def test_statistics(good, scene):
    path = scene(body=DEVICE)
    result = good("servo", path, "--rate", "500", "--engage", "--deadline", "10", "--no-lock", "--json").json
    assert result["period_ns"] == 2_000_000 and result["ticks"] > 0 and not result["memory_locked"]
    for name in ("tick", "late"):
        assert sum(result[f"{name}_histogram"]["counts"]) == result["ticks"]
        times = result[f"{name}_ns"]
        assert times["p50"] <= times["p99"] <= times["p9999"] <= times["max"]
    text = good("servo", path, "--seconds", "0.1").out
    assert "ticks of 1 ms" in text and "woken late" in text


def test_one_device_is_needed(refused, scene):
    refused(1, "motion|device", "servo", scene())
    body = dict({"map": "box"}, **DEVICE)
    refused(1, "bodies[1]|one device", "servo", scene(bodies=[body, dict(body, name="other")]))


def test_arguments(refused, scene):
    path = scene(body=DEVICE)
    for option, value in (("--rate", "99"), ("--rate", "6000"), ("--priority", "100"), ("--force-scale", "-1"),
                          ("--torque-scale", "-1"), ("--deadline", "0"), ("--anchor", "1,2")):
        refused(2, option, "servo", path, option, value)


def test_a_simulated_device_is_recorded_and_replayed(good, scene, tmp_path):
    recording = tmp_path / "session.frmrec"
    result = good("servo", scene(dt=0.001, body=DEVICE), "--device", "sim", "--calibrate", "--engage", "--deadline", "10",
                  "--anchor", "0,0,-0.1", "--record", recording, "--force-interval", "4", "--no-lock", "--json").json
    assert result["faults"] == 0 and result["failed_exchanges"] == 0
    replayed = good("replay", recording, "--json").json
    assert replayed["identical"] and replayed["ticks"] == result["ticks"]
    good("replay", recording, "--csv", tmp_path / "t.csv", "--device-csv", tmp_path / "d.csv")
    with open(tmp_path / "d.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0])[-2:] == ["faults", "raw"] and len(rows) == result["ticks"]
    assert all(row["status"] == "0" and row["faults"] == "0" and len(row["raw"]) > 80 for row in rows)
    kept = [float(row["achieved_fz"]) for row in rows if row["achieved_fz"]]
    assert len(kept) * 4 - len(rows) in range(4) and max(kept) > 1e-3  # the box is lifted
    # What it did, a device of a recording does again; and a recording under its bare name is one.
    again = scene("again.json", body={"motion": {"type": "device", "device": str(recording)}})
    for arguments in ((again,), (scene(body=DEVICE), "--device", f"replay:{recording}")):
        ended = good("servo", *arguments, "--anchor", "0,0,-0.1", "--seconds", "60", "--record", tmp_path / "again.frmrec",
                     "--json").json
        assert ended["status"] == "FRM_ERROR_END"
        replayed = good("replay", tmp_path / "again.frmrec", "--json").json
        assert replayed["identical"] and replayed["ticks"] == result["ticks"]


def test_a_device_that_is_not_calibrated_gives_no_force(frm, scene, tmp_path):
    outcome = frm("servo", scene(body=DEVICE), "--device", "sim", "--engage", "--seconds", "0.05", "--json")
    assert outcome.status == 1 and outcome.json["faults"] & 1 and "calibrate" in outcome.json["reason"]


def test_devices_are_refused(refused, scene, tmp_path):
    path = scene(body=DEVICE)
    before = sorted(tmp_path.iterdir())
    refused(1, "no such driver", "servo", path, "--device", "hand", "--record", tmp_path / "r.frmrec")
    refused(1, "number 0", "servo", path, "--device", "sim", "--index", "1", "--record", tmp_path / "r.frmrec")
    refused(1, "--rate|period", "servo", path, "--device", "sim", "--rate", "500", "--record", tmp_path / "r.frmrec")
    refused(1, "read by this command", "servo", path, "--device", "sim", "--record", tmp_path / "box.frm")
    refused(1, "read by this command", "servo", path, "--device", "sim", "--record", path)
    refused(1, "none.frmrec", "servo", scene(body={"motion": {"type": "device", "device": "none.frmrec"}}))
    assert sorted(tmp_path.iterdir()) == before


def test_a_device_for_real_time_is_not_run(good, refused, scene, tmp_path):
    sim = scene(body={"motion": {"type": "device", "device": "sim"}})
    refused(1, "bodies[0]|sim|frm servo", "run", sim)
    good("device", "record", "sim", "--calibrate", "--rate", "500", "--seconds", "0.5", "-o", tmp_path / "s.frmrec")
    again = {"type": "device", "device": f"replay:{tmp_path / 's.frmrec'}"}
    assert good("run", scene("again.json", seconds=0.2, body={"motion": again}), "--json").json["ticks"] == 100
    refused(1, "read by this command", "run", tmp_path / "again.json", "--record", tmp_path / "s.frmrec")


def test_another_period(good, scene, tmp_path):
    device = json.loads((ROOT / "samples" / "devices" / "SpidarG6X3R.json").read_text())
    device["period"] = 0.002
    (tmp_path / "slow.json").write_text(json.dumps(device))
    name = f"sim:{tmp_path / 'slow.json'}"
    assert good("servo", scene(body={"motion": {"type": "device", "device": name}}), "--rate", "500", "--json").json["ticks"]


def test_monitor_and_record_calibrate(good, tmp_path):
    lines = good("device", "monitor", "sim", "--rate", "5000", "--seconds", "0.01", "--json").out.splitlines()
    assert {json.loads(line)["status"] for line in lines} == {"uncalibrated"}
    assert json.loads(lines[0])["faults"] == ["uncalibrated"]
    lines = good("device", "monitor", "sim", "--calibrate", "--rate", "5000", "--seconds", "0.01", "--json").out.splitlines()
    assert {json.loads(line)["status"] for line in lines} == {"ready"} and json.loads(lines[0])["faults"] == []
    good("device", "record", "sim", "--calibrate", "--seconds", "0.05", "-o", tmp_path / "s.frmrec")
    assert good("replay", tmp_path / "s.frmrec", "--json").json["identical"]
    assert good("device", "list", f"replay:{tmp_path / 's.frmrec'}", "--json").json["devices"][0]["name"].endswith("(simulated)")
