"""The samples of devices of a host's own, in C and in Python: compiled and run as their heads say."""
from __future__ import annotations

import os
import pathlib
import re
import shutil
import subprocess
import sys

import pytest
from conftest import ROOT

import frm

LINES = [(0.0, 0.0002 * n) for n in range(150)]  # 0.1 m/s along y, 500 a second


def felt(output: str) -> tuple[int, float, float]:
    match = re.fullmatch(r"(\d+) lines; felt at the end: (\S+) (\S+) N\n", output)
    assert match, output
    return int(match[1]), float(match[2]), float(match[3])


@pytest.fixture(scope="module")
def expected() -> float:
    """What the body feels in the last tick but one, by the library itself: the last that could be displayed."""
    with frm.Context() as context:
        world = frm.World(context)
        body = frm.Body(world, frm.Map(context, os.environ["FRM_TEST_MAP"]))
        forces = []
        for n, (x, y) in enumerate(LINES):
            body.set_motion(((x, y, -0.3), (0, 0, 0, 1)), ((0, 0.1 if n else 0, 0), (0, 0, 0)))
            world.tick(0.002)
            f = body.forces()
            forces.append(f.pressure.force.y + f.friction.force.y)
    return forces[-1]


def run(command, **more) -> str:
    done = subprocess.run(command, input="".join(f"{x} {y:.9g}\n" for x, y in LINES), text=True, capture_output=True,
                          timeout=120, **more)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_in_c(tmp_path, expected):
    compiler = shutil.which("cc")
    if not compiler:
        pytest.skip("no C compiler: cc")
    library = pathlib.Path(os.environ["FRM_LIBRARY"]).resolve()
    if "asan" in subprocess.run(["ldd", library], capture_output=True, text=True).stdout:
        pytest.skip("a program without the sanitizers cannot load a library with them")
    program = tmp_path / "host_device"
    subprocess.run([compiler, "-std=c99", "-Wall", "-Werror", "-I", ROOT / "include", ROOT / "samples/host_device.c",
                    "-o", program, library, f"-Wl,-rpath,{library.parent}"], check=True)
    lines, x, y = felt(run([program, os.environ["FRM_TEST_MAP"]]))
    assert lines == len(LINES)
    assert abs(x) < 0.01 and y < 0
    assert y == pytest.approx(expected, rel=0.02)


def test_in_python(expected):
    environment = dict(os.environ, PYTHONPATH=str(ROOT / "bindings/python"), PYTHONDONTWRITEBYTECODE="1")
    lines, x, y = felt(run([sys.executable, ROOT / "samples/host_device.py", os.environ["FRM_TEST_MAP"]],
                           env=environment))
    assert lines == len(LINES)
    assert abs(x) < 0.01 and y == pytest.approx(expected, rel=0.02)


def test_servo_and_safety(context):
    """The binding's own words for them, on the null device."""
    world = frm.World(context)
    body = frm.Body(world, frm.Map(context, os.environ["FRM_TEST_MAP"]))
    device = frm.Device.open_null(context)
    device.set_safety(ramp_time=0.5, deadline_ns=10_000_000_000)
    device.engage()
    device.exchange(((1, 0, 0), (0, 0, 0)))
    assert device.safety().engaged == 1 and device.safety().faults == 0 and device.safety().reason == b""
    with pytest.raises(frm.Error) as caught:
        device.exchange(((float("nan"), 0, 0), (0, 0, 0)))
    assert caught.value.status == frm.ERROR_ARGUMENT
    assert device.safety().faults == frm.DEVICE_FAULT_COMMAND and b"not finite" in device.safety().reason
    with pytest.raises(frm.Error) as caught:
        device.engage()
    assert caught.value.status == frm.ERROR_STATE
    device.clear_fault()
    device.engage()
    device.disengage()

    ticks, refused = [], []

    def on_tick(user, tick, dt):
        ticks.append((tick, dt))
        return frm.ERROR_END if tick >= 20 and refused else frm.OK

    with frm.Servo(context, device, body, rate=200, lock_memory=0, on_tick=on_tick) as servo:
        servo.set_input(force_scale=2, anchor=((0, 0, -0.3), (0, 0, 0, 1)))
        servo.engage()
        servo.start()
        with pytest.raises(frm.Error) as caught:
            world.tick(0.001)
        refused.append(True)
        assert caught.value.status == frm.ERROR_STATE
        while servo.state().running:
            pass
        state = servo.state()
        assert state.status == frm.ERROR_END and b"on_tick" in state.reason
        assert ticks[-1][0] >= 20 and ticks[-1][1] == pytest.approx(0.005)
        assert tuple(state.pose.position) == pytest.approx((0, 0, -0.3))
        assert servo.stats().ticks == sum(count for _, count in servo.histogram())
        servo.clear_fault()
        servo.disengage()
        servo.stop()
    world.tick(0.001)
