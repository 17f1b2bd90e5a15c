"""frm replay: ranges, tolerances, tables; frm device."""
import csv
import json
import subprocess
from pathlib import Path

import pytest

from conftest import PROGRAM, ROOT, names

DATA = ROOT / "tests" / "data"


def read_csv(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_a_range_by_time_or_tick(good, refused, scene, tmp_path):
    good("run", scene(), "--record", tmp_path / "r.frmrec")
    j = good("replay", tmp_path / "r.frmrec", "--from", "0.1", "--to", "100t", "--json").json
    assert j["identical"] and j["compared"] == 51 and j["replayed"] == 100  # ticks 50 to 100
    refused(1, "no tick|150", "replay", tmp_path / "r.frmrec", "--from", "200t")
    for bad in ("1.5x", "-1", "t", "nan"):
        refused(2, "--from", "replay", tmp_path / "r.frmrec", f"--from={bad}")


def test_tables_hold_what_was_recorded(good, scene, tmp_path):
    good("run", scene(), "--record", tmp_path / "r.frmrec", "--csv", tmp_path / "run.csv")
    good("replay", tmp_path / "r.frmrec", "--csv", tmp_path / "r.csv")
    recorded, run = read_csv(tmp_path / "r.csv"), read_csv(tmp_path / "run.csv")
    assert len(recorded) == len(run) == 150
    for n, (a, b) in enumerate(zip(recorded, run)):
        assert a["tick"] == str(n + 1) and a["body"] == "0"
        for column in ("fx", "tz", "pressure_fy", "buoyancy_fz"):
            assert float(a[column]) == float(b[column])
    assert float(recorded[99]["px"]) == pytest.approx(-0.1 + 0.4 * 99 * 0.002)
    some = good("replay", tmp_path / "r.frmrec", "--csv", tmp_path / "some.csv", "--from", "100t", "--to", "0.24",
                "--json").json
    assert some["ticks"] == len(read_csv(tmp_path / "some.csv")) == 21 - 1 + (float(recorded[119]["time"]) <= 0.24)
    assert read_csv(tmp_path / "some.csv")[0] == recorded[99]


def test_a_table_is_whole_or_not_there(refused, good, scene, tmp_path):
    good("run", scene(), "--record", tmp_path / "r.frmrec")
    data = bytearray((tmp_path / "r.frmrec").read_bytes())
    data[len(data) * 3 // 4] ^= 1
    (tmp_path / "bad.frmrec").write_bytes(data)
    before = names(tmp_path)
    refused(1, "bad.frmrec|block", "replay", tmp_path / "bad.frmrec", "--csv", tmp_path / "t.csv")
    refused(1, "r.frmrec|read by this command", "replay", tmp_path / "r.frmrec", "--csv", tmp_path / "r.frmrec")
    refused(1, "two outputs", "replay", tmp_path / "r.frmrec", "--csv", tmp_path / "t", "--device-csv", tmp_path / "t")
    assert names(tmp_path) == before


def test_a_difference_is_named(frm):
    # Its forces are those of a version that had other rules.
    outcome = frm("replay", DATA / "v1.frmrec", "--json")
    first = outcome.json["first_difference"]
    assert outcome.status == 1 and not outcome.json["identical"] and first["tick"] >= 1
    assert set(first) == {"tick", "time", "body", "part", "component", "recorded", "replayed"}
    text = frm("replay", DATA / "v1.frmrec").out
    assert f"tick {first['tick']}," in text and "recorded" in text and first["component"] in text
    near = frm("replay", DATA / "v1.frmrec", "--tolerance", "0.01", "--json").json
    assert near["within_tolerance"] or near["first_difference"]["tick"] > first["tick"]
    wide = frm("replay", DATA / "v1.frmrec", "--tolerance", "1", "--force", "1e6", "--torque", "1e6", "--json")
    assert wide.status == 0 and wide.json["within_tolerance"] and not wide.json["identical"]


def test_devices_are_listed_watched_and_recorded(good, refused, tmp_path):
    listed = good("device", "list", "--json").json["devices"]
    assert [d["device"] for d in listed[:2]] == ["null", "sim"]  # and each SPIDAR-G that is there
    j = good("device", "record", "null", "--rate", "2000", "--seconds", "0.05", "-o", tmp_path / "n.frmrec", "--json").json
    assert j["cycles"] == 100 and j["lost_events"] == 0 and names(tmp_path) == ["n.frmrec"]
    assert good("replay", tmp_path / "n.frmrec", "--json").json["ticks"] == 100
    again = f"replay:{tmp_path / 'n.frmrec'}"
    assert good("device", "list", again, "--json").json["devices"][0]["name"] == "null"
    lines = good("device", "monitor", again, "--rate", "5000", "--json").out.splitlines()
    assert [json.loads(line)["sequence"] for line in lines] == list(range(100))
    assert "calibrated" in good("device", "calibrate", "null").out
    copied = good("device", "record", again, "-o", tmp_path / "c.frmrec", "--rate", "5000", "--json").json
    assert copied["cycles"] == 100
    refused(1, "no such driver|null|replay:FILE", "device", "monitor", "hand")
    refused(1, "FILE is needed", "device", "monitor", "replay")
    refused(1, "nothing after a colon", "device", "calibrate", "null:x")
    refused(1, "number 0", "device", "monitor", "null", "--index", "1")
    refused(1, "holds 1 devices", "device", "record", again, "--index", "1", "-o", tmp_path / "x.frmrec")
    refused(1, "read by this command", "device", "record", again, "-o", tmp_path / "n.frmrec")
    assert names(tmp_path) == ["c.frmrec", "n.frmrec"]


def test_packets_are_in_the_table(good, tmp_path):
    hand = DATA / "recordings" / "hand.frmrec"
    good("replay", hand, "--device-csv", tmp_path / "d.csv", "--to", "50t")
    rows = read_csv(tmp_path / "d.csv")
    assert len(rows) == 50 and [int(r["sequence"]) for r in rows] == list(range(50))
    # As scripts/renew-recordings made them.
    for n, row in enumerate(rows):
        raw = bytes.fromhex(row["raw"])
        assert raw == bytes(((n + 1) * (i + 1)) >> 4 & 0xFF if i < 16 else i for i in range(32))
    assert float(rows[0]["pz"]) == 0.08


def test_renewing_leaves_what_is_the_same(tmp_path, scene, good):
    script = ROOT / "scripts" / "renew-recordings"

    def renew(*arguments):
        return subprocess.run([script, "--folder", tmp_path, "--program", PROGRAM, *arguments], text=True,
                              capture_output=True)
    path = scene(seconds=0.1)
    assert renew("--check").returncode == 1 and names(tmp_path) == ["box.frm", "scene.json"]
    assert "recorded anew" in renew().stdout
    first = (tmp_path / "scene.frmrec").read_bytes()
    assert "as it was" in renew().stdout and renew("--check").returncode == 0
    # A recording of another version in its place: replaced, and it says where it differs.
    (tmp_path / "scene.frmrec").write_bytes((DATA / "v1.frmrec").read_bytes())
    assert renew("--check").returncode == 1
    outcome = renew("scene")
    assert outcome.returncode == 0 and "differs first at tick" in outcome.stdout
    assert (tmp_path / "scene.frmrec").read_bytes() == first and Path(path).exists()
    assert renew("nothing").returncode != 0
