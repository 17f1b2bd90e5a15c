"""frm servo: a scene in real time. Nothing here says how long anything takes."""

DEVICE = {"motion": {"type": "device", "device": "null"}}


def test_statistics(good, scene):
    path = scene(body=DEVICE)
    result = good("servo", path, "--rate", "500", "--engage", "--no-lock", "--json").json
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
    for option, value in (("--rate", "99"), ("--rate", "6000"), ("--priority", "100"), ("--force-scale", "-1")):
        refused(2, option, "servo", path, option, value)
