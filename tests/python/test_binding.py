"""The binding over the real library."""
from __future__ import annotations

import ctypes
import ctypes.util
import gc
import threading
import time
from array import array

import pytest
from conftest import ROOT

import frm
from frm import _buffers, _library

numpy = pytest.importorskip("numpy")


@pytest.fixture(params=["numpy", "array"])
def arrays(request, monkeypatch):
    """The binding with numpy, and as if there were none."""
    if request.param == "array":
        monkeypatch.setattr(_buffers, "numpy", None)
    return request.param


# ---- Library and errors ------------------------------------------------------------------------------------

def test_version(library):
    assert frm.version()[0] == frm.VERSION_MAJOR
    assert frm.__version__.count(".") == 2


def test_missing_library(monkeypatch, tmp_path):
    monkeypatch.setenv("FRM_LIBRARY", str(tmp_path / "none.so"))
    assert _library.candidates() == [str(tmp_path / "none.so")]
    with pytest.raises(frm.LibraryError, match="none.so"):
        _library.load(str(tmp_path / "none.so"))


def test_other_library_is_refused():
    libc = ctypes.util.find_library("c")
    with pytest.raises(frm.LibraryError, match="not the frm library"):
        _library.load(libc)


def test_error_has_status_and_text(context):
    with pytest.raises(frm.Error) as caught:
        frm.World(context, density=-1.0)
    assert caught.value.status is frm.Status.ERROR_ARGUMENT
    assert "density" in caught.value.text
    assert "FRM_ERROR_ARGUMENT" in str(caught.value)


def test_missing_map(context, tmp_path):
    with pytest.raises(frm.Error) as caught:
        frm.Map(context, tmp_path / "none.frm")
    assert caught.value.status == frm.ERROR_FILE
    assert caught.value.text


def test_damaged_map(context):
    with pytest.raises(frm.Error) as caught:
        frm.Map.open_memory(context, b"not a map at all" * 20)
    assert caught.value.status in (frm.ERROR_CORRUPT, frm.ERROR_VERSION)


def test_unknown_option_is_named(context):
    with pytest.raises(TypeError, match="World.*'densty'.*density"):
        frm.World(context, densty=1000)
    with pytest.raises(TypeError, match="struct_size"):
        frm.World(context, struct_size=4)


def test_options_of_the_wrong_kind(context):
    with pytest.raises(TypeError, match="World.density="):
        frm.World(context, density="heavy")
    with pytest.raises(OverflowError, match="nx"):
        frm.Water(frm.World(context), nx=2**32 + 200)


def test_dt_out_of_range(context):
    world = frm.World(context)
    for dt in (0.0, -0.002, 1.0, float("nan")):
        with pytest.raises(frm.Error):
            world.tick(dt)
    assert world.stats().ticks == 0


# ---- Lives -------------------------------------------------------------------------------------------------

def test_close_is_idempotent(library):
    context = frm.Context()
    world = frm.World(context)
    world.close()
    world.close()
    assert world.closed and "closed" in repr(world)
    context.close()
    context.close()
    assert context.closed


def test_stale_handles_raise(library):
    context = frm.Context()
    world = frm.World(context)
    water = frm.Water(world, nx=32, ny=32, border_cells=2)
    handle = world.handle
    world.close()
    for call in (world.stats, lambda: world.tick(0.002), water.read, water.read_snapshot):
        with pytest.raises(frm.Error) as caught:
            call()
        assert caught.value.status == frm.ERROR_HANDLE
    water.close()
    other = frm.World(context)
    assert other.handle != handle
    context.close()
    with pytest.raises(frm.Error) as caught:
        other.tick(0.002)
    assert caught.value.status == frm.ERROR_HANDLE
    other.close()


def test_a_context_that_nobody_holds_is_destroyed(library):
    context = frm.Context()
    handle = context.handle
    world = frm.World(context)
    del context
    gc.collect()
    world.tick(0.002)
    del world
    gc.collect()
    assert library.frm_context_destroy(handle) == frm.ERROR_HANDLE


def test_contexts_are_bounded_but_reused(library):
    for _ in range(100):
        with frm.Context() as context:
            frm.World(context).tick(0.002)


def test_allocator_in_python(library):
    libc = ctypes.CDLL(None)
    libc.aligned_alloc.restype = ctypes.c_void_p
    libc.aligned_alloc.argtypes = (ctypes.c_size_t, ctypes.c_size_t)
    libc.free.argtypes = (ctypes.c_void_p,)
    held = {}

    def allocate(user, size, alignment):
        memory = libc.aligned_alloc(alignment, -(-size // alignment) * alignment)
        held[memory] = size, alignment
        return memory

    def release(user, memory, size, alignment):
        assert held.pop(memory) == (size, alignment)
        libc.free(memory)

    with frm.Context(allocate=allocate, release=release) as context:
        water = frm.Water(frm.World(context), nx=32, ny=32, border_cells=2)
        assert held
        assert water.read().nx == 32
    assert not held


def test_log_is_empty_or_text(context):
    while (message := context.poll_log()) is not None:
        level, text = message
        assert isinstance(level, frm.LogLevel) and text


# ---- Values ------------------------------------------------------------------------------------------------

def test_structs_from_sequences(library):
    pose = frm._abi.convert(frm.Pose, ([1, 2, 3], numpy.array([0, 0, 0, 1.0])))
    assert tuple(pose.position) == (1, 2, 3) and pose.rotation.w == 1 and pose.position[1] == 2
    assert pose == frm.Pose((1, 2, 3), (0, 0, 0, 1)) and pose != frm.Pose()
    assert "position=Position(x=1.0" in repr(pose)
    with pytest.raises(TypeError, match="3 values"):
        frm._abi.convert(frm.Vec3, (1, 2))


def test_enum_values(library):
    assert (frm.MODEL_DISPLACEMENT | frm.MODEL_OWN_WAVES | frm.MODEL_FLUCTUATION | frm.MODEL_SPEEDS
            | frm.MODEL_SPIN == frm.MODEL_DEFAULT)
    assert library.frm_status_name(frm.ERROR_END) == b"FRM_ERROR_END"


# ---- World and water without a body ------------------------------------------------------------------------

def test_water_waves(context, arrays):
    world = frm.World(context, model=frm.MODEL_PAPER, level=1.5)
    water = frm.Water(world, nx=40, ny=24, border_cells=2, cell=0.05, depth=0.4, border=frm.BORDER_REFLECTING,
                      centre_x=3.0)
    definition = water.definition()
    assert (definition.nx, definition.ny, definition.centre_x) == (40, 24, 3.0)
    height = [0.0] * (40 * 24)
    height[12 * 40 + 20] = 0.01
    water.set_height(array("f", height))
    before = water.read(velocity_x=True, velocity_y=True)
    assert (before.nx, before.ny, before.tick) == (40, 24, 0)
    if arrays == "numpy":
        assert before.height.shape == (24, 40) and before.height[12, 20] == numpy.float32(0.01)
    else:
        assert isinstance(before.height, array) and before.height[12 * 40 + 20] == pytest.approx(0.01)
    for _ in range(50):
        world.tick(0.002)
    after = water.read()
    assert after.tick == 50 and after.time == pytest.approx(0.1)
    assert after.velocity_x is None
    flat = list(numpy.ravel(after.height))
    assert sum(flat) == pytest.approx(sum(height), abs=1e-6) and max(flat) < 0.01
    cell = (definition.centre_x + (20 - 19.5) * 0.05, (12 - 11.5) * 0.05)
    assert water.height(*cell) == pytest.approx(1.5 + flat[12 * 40 + 20], abs=1e-6)
    assert water.height(100.0, 0.0) == 1.5


def test_the_same_heights_from_any_buffer(context, arrays):
    world = frm.World(context)
    water = frm.Water(world, nx=16, ny=12, border_cells=2)
    numbers = numpy.sin(numpy.arange(192.0)).astype(numpy.float32) * 0.01
    read_only = numbers.copy()
    read_only.flags.writeable = False
    given = [numbers, numbers.reshape(12, 16), array("f", numbers), numbers.tolist(), read_only,
             memoryview(numbers), bytes(numbers.tobytes())]
    if arrays == "numpy":
        given += [numbers.astype(float), numpy.repeat(numbers, 2)[::2], numbers.astype(">f4")]
    for values in given:
        water.set_height(numpy.zeros(192, numpy.float32))
        if isinstance(values, bytes):
            values = memoryview(values).cast("f")
        water.set_height(values)
        assert numpy.array_equal(numpy.ravel(water.read().height), numbers)


def test_buffers_are_used_in_place(context):
    numbers = numpy.zeros((8, 8), numpy.float32)
    pointer, count = _buffers.floats_in(numbers)
    assert count == 64 and ctypes.addressof(pointer) == numbers.ctypes.data
    water = frm.Water(frm.World(context), nx=8, ny=8, border_cells=0)
    water.set_height(numpy.full(64, 0.25, numpy.float32))
    field = water.read(height=numbers)
    assert field.height is numbers and (numbers == 0.25).all()
    with pytest.raises(TypeError, match="float32"):
        water.read(height=numpy.zeros(64))
    with pytest.raises(frm.Error) as caught:
        water.read(height=array("f", [0] * 63))
    assert caught.value.status == frm.ERROR_CAPACITY


def test_wrong_count(context):
    water = frm.Water(frm.World(context), nx=16, ny=16, border_cells=2)
    with pytest.raises(frm.Error) as caught:
        water.set_height([0.0] * 255)
    assert caught.value.status == frm.ERROR_ARGUMENT


def test_pressure_raises_the_water(context, arrays):
    world = frm.World(context)
    water = frm.Water(world, nx=32, ny=32, border_cells=2, cell=0.05)
    pressure = array("f", [0.0] * 1024)
    for j in range(14, 18):
        for i in range(14, 18):
            pressure[j * 32 + i] = 50.0
    water.set_pressure(pressure)
    for _ in range(20):
        world.tick(0.002)
    assert water.height(0.0, 0.0) > 0
    water.set_pressure(None)


def test_snapshots_from_another_thread(context):
    world = frm.World(context)
    water = frm.Water(world, nx=64, ny=64, cell=0.05, snapshot_interval=0.0)
    bump = numpy.zeros((64, 64), numpy.float32)
    bump[30:34, 30:34] = 0.02
    water.set_height(bump)
    world.tick(0.001)
    stop, failures, ticks = threading.Event(), [], []

    def reader():
        buffer = numpy.empty((64, 64), numpy.float32)
        while not stop.is_set():
            try:
                field = water.read_snapshot(height=buffer)
                assert not ticks or field.tick >= ticks[-1]
                assert numpy.isfinite(buffer).all() and numpy.abs(buffer).max() <= 0.03
                ticks.append(field.tick)
            except Exception as exception:
                failures.append(exception)
                return

    thread = threading.Thread(target=reader)
    thread.start()
    begin = time.monotonic()
    while time.monotonic() < begin + 0.5 or (len(set(ticks)) <= 5 and time.monotonic() < begin + 60):
        world.tick(0.001)
    stop.set()
    thread.join()
    assert not failures
    assert len(set(ticks)) > 5
    water.read_snapshot()  # the reader may have slept for long; after a read the next ticks make another
    for _ in range(8):
        world.tick(0.001)
    assert world.stats().ticks - 8 <= water.read_snapshot().tick <= world.stats().ticks  # of the water's last step


def test_hash_tells_worlds_apart(context):
    first, second = (frm.World(context) for _ in range(2))
    for world in (first, second):
        frm.Water(world, nx=16, ny=16, border_cells=2).set_height([0.01] + [0.0] * 255)
        world.tick(0.002)
    assert first.hash() == second.hash()
    second.tick(0.002)
    assert first.hash() != second.hash()


# ---- Map and body ------------------------------------------------------------------------------------------

def test_map(context, map_path):
    map = frm.Map(context, map_path)
    info = map.info()
    assert info.sources > 0 and info.volume > 0
    with open(map_path, "rb") as file:
        again = frm.Map.open_memory(context, file.read())
    assert again.info().content_hash == info.content_hash
    areas = [map.source(index).area for index in range(info.sources)]
    assert sum(areas) == pytest.approx(info.area, rel=1e-3)
    assert map.provenance().lstrip().startswith("{")
    with pytest.raises(frm.Error):
        map.source(info.sources)
    again.close()


def test_added_mass(context, map_path):
    map = frm.Map(context, map_path)
    assert map.info().has_added_mass == 1
    mass = map.added_mass()
    assert len(mass) == 6 and all(len(row) == 6 for row in mass)
    assert all(mass[i][j] == mass[j][i] and mass[i][i] > 0 for i in range(6) for j in range(6))
    larger = map.added_mass(density=2000, scale=3)
    for i in range(6):
        for j in range(6):
            assert larger[i][j] == pytest.approx(2 * 3 ** (3 + (i >= 3) + (j >= 3)) * mass[i][j], rel=1e-12)
    with pytest.raises(frm.Error, match="density"):
        map.added_mass(density=-1)
    old = frm.Map(context, ROOT / "tests" / "data" / "v1.frm")
    assert (old.info().format_version, old.info().speeds, old.info().has_added_mass) == (1, 1, 0)
    with pytest.raises(frm.Error, match="without added mass") as caught:
        old.added_mass()
    assert caught.value.status == frm.Status.ERROR_STATE


@pytest.mark.parametrize("axes", list(frm.Axes))
def test_added_mass_in_the_hosts_axes(map_path, axes):
    """The kinetic energy of a motion is the same in any axes, and the motion's own numbers say which is which."""
    with frm.Context() as plain, frm.Context(axes=axes) as context:
        ours, theirs = frm.Map(plain, map_path).added_mass(), frm.Map(context, map_path).added_mass()
    mirrored = axes in (frm.AXES_Y_UP_LEFT, frm.AXES_Z_UP_LEFT)

    def host(v):
        if axes == frm.AXES_Y_UP_LEFT:
            return [-v[0], v[1], v[2]]
        return [v[0], v[2], v[1]] if axes == frm.AXES_Z_UP_LEFT else list(v)

    def energy(mass, twist):
        return sum(twist[i] * mass[i][j] * twist[j] for i in range(6) for j in range(6))
    linear, angular = [0.3, -1.1, 0.7], [0.2, 0.5, -0.9]
    turned = [-c for c in host(angular)] if mirrored else host(angular)
    assert energy(theirs, host(linear) + turned) == pytest.approx(energy(ours, linear + angular), rel=1e-12)


def test_body(context, map_path, arrays):
    map = frm.Map(context, map_path)
    world = frm.World(context)
    body = frm.Body(world, map, mass=1.2, scale=1, pose=((0, 0, 0), (0, 0, 0, 1)))
    assert tuple(body.forces().total.force) == (0, 0, 0)
    for tick in range(20):
        body.set_motion(((0.5 * 0.002 * tick, 0, 0), (0, 0, 0, 1)), ((0.5, 0, 0), (0, 0, 0)))
        world.tick(0.002)
    forces = body.forces()
    for axis in range(3):
        parts = [getattr(forces, part).force[axis] for part in ("buoyancy", "pressure", "friction",
                                                                "gravity")]
        assert forces.total.force[axis] == pytest.approx(sum(parts), abs=1e-4)
    assert forces.buoyancy.force.z > 0 and forces.pressure.force.x < 0
    assert forces.gravity.force.z == pytest.approx(-1.2 * 9.80665, rel=1e-6)
    state = body.state()
    assert state.wet_area > 0 and state.twist.linear.x == 0.5
    coefficients = body.coefficients()
    assert 0 < coefficients.wet_share <= 1 and coefficients.damping[0] > -forces.pressure.force.x / 0.5
    assert coefficients.added_mass[0] == pytest.approx(coefficients.wet_share * map.added_mass()[0][0], rel=1e-5)
    sources = body.sources()
    assert len(sources) == map.info().sources
    if arrays == "numpy":
        wet = int((sources["wet_ratio"] > 0).sum())
        assert sources["force"].shape == (len(sources), 3)
        resistance = sources["force"].sum(axis=0)
        expected = numpy.array(tuple(forces.pressure.force)) + tuple(forces.friction.force)
        assert numpy.allclose(resistance, expected, rtol=1e-3, atol=1e-4)
    else:
        assert isinstance(sources[0], frm.SourceState)
        wet = sum(source.wet_ratio > 0 for source in sources)
    assert wet == state.wet_sources
    with pytest.raises(frm.Error) as caught:
        map.close()
    assert caught.value.status == frm.ERROR_STATE and not map.closed
    body.close()
    map.close()


# ---- Devices -----------------------------------------------------------------------------------------------

def device_packet(exchange):
    return bytes([exchange, 7]) * 5


class Swing(frm.Driver):
    """Two devices; the grip follows the force that it is told to display."""

    def __init__(self):
        self.closed, self.stopped, self.calibrated = [], 0, 0
        self.fail = None

    def enumerate(self):
        return [frm.DeviceInfo(serial=number, max_force=5.0, name=b"swing") for number in (7, 8)]

    def open(self, index):
        if index > 1:
            raise IndexError("there are two")
        return {"index": index, "exchanges": 0}

    def close(self, instance):
        self.closed.append(instance["index"])

    def info(self, instance):
        return self.enumerate()[instance["index"]]

    def calibrate(self, instance):
        self.calibrated += 1

    def raw(self, instance):
        return device_packet(instance["exchanges"] - 1)

    def exchange(self, instance, command, state):
        if self.fail:
            raise self.fail
        state.status = frm.DEVICE_READY
        state.pose = frm.Pose((command.wrench.force.x, 0.25, 0), (0, 0, 0, 1))
        state.sequence = instance["exchanges"]
        state.time_ns = instance["exchanges"] * 1_000_000
        instance["exchanges"] += 1

    def stop(self, instance):
        self.stopped += 1


def test_null_device(context):
    with frm.Device.open_null(context) as device:
        assert isinstance(device.info().name, bytes)
        states = [device.exchange() for _ in range(3)]
        assert [state.sequence for state in states] == [0, 1, 2]
        assert states[2].time_ns - states[1].time_ns == 2_000_000
        device.calibrate()
        device.stop()
    with pytest.raises(frm.Error):
        device.exchange()


def test_driver_in_python(context):
    driver = Swing()
    infos = frm.Device.enumerate(context, driver)
    assert [(info.serial, info.name) for info in infos] == [(7, b"swing"), (8, b"swing")]
    device = frm.Device(context, driver, 1)
    assert device.info().serial == 8
    device.calibrate()
    state = device.exchange(((1.5, 0, 0), (0, 0, 0)), deadline_ns=10_000_000)
    assert tuple(state.pose.position) == (0, 0.25, 0) and state.sequence == 0  # it is not engaged
    assert device.exchange().sequence == 1
    device.stop()
    device.close()
    device.close()
    assert driver.closed == [1] and driver.stopped >= 1 and driver.calibrated == 1


def test_driver_exceptions_are_device_errors(context):
    driver = Swing()
    with pytest.raises(frm.Error) as caught:
        frm.Device(context, driver, 5)
    assert caught.value.status == frm.ERROR_DEVICE
    assert isinstance(caught.value.__cause__, IndexError)
    device = frm.Device(context, driver)
    driver.fail = RuntimeError("cable is out")
    with pytest.raises(frm.Error) as caught:
        device.exchange()
    assert caught.value.status == frm.ERROR_DEVICE
    assert str(caught.value.__cause__) == "cable is out"
    driver.fail = KeyboardInterrupt()
    with pytest.raises(KeyboardInterrupt):
        device.exchange()
    driver.fail = None
    device.exchange()


def test_driver_lives_as_long_as_the_context(library):
    closed = []

    class Quiet(Swing):
        def close(self, instance):
            closed.append(instance["index"])

    context = frm.Context()
    frm.Device(context, Quiet(), 0)
    gc.collect()
    context.close()
    assert closed == [0]


def test_command_that_is_not_finite_is_refused(context):
    driver = Swing()
    device = frm.Device(context, driver)
    with pytest.raises(frm.Error) as caught:
        device.exchange(((float("nan"), 0, 0), (0, 0, 0)))
    assert caught.value.status == frm.ERROR_ARGUMENT


# ---- Recorder and replay -----------------------------------------------------------------------------------

def test_replay_gives_the_same_bits(context, record):
    path, totals = record(ticks=150)
    replay = frm.Replay(context, path)
    info = replay.info()
    assert (info.ticks, info.bodies, info.has_water, info.maps, info.torn) == (150, 1, 1, 1, 0)
    for index, result in enumerate(replay):
        assert (result.tick, result.diverged, result.part) == (index + 1, 0, frm.PART_NONE)
        assert tuple(replay.body(0).forces().total.force) == totals[index]
    assert index == 149
    with pytest.raises(frm.Error) as caught:
        replay.step()
    assert caught.value.status == frm.ERROR_END
    assert replay.water().read().height.shape == (48, 64)
    assert replay.world().stats().ticks == 150
    assert replay.map(0).info().sources > 0
    replay.world().close()
    replay.close()
    replay.close()


def test_a_tolerance_passes_what_is_near(context, record):
    path, _ = record(ticks=20)
    with frm.Replay(context, path) as replay:
        replay.set_tolerance(relative=1e-6, force=0.1, torque=0.1)
        assert not any(result.diverged for result in replay)
        with pytest.raises(frm.Error):
            replay.set_tolerance(relative=-1)


def test_recording_of_water_alone(context, tmp_path):
    path = tmp_path / "water.rec"
    world = frm.World(context)
    with frm.Recorder(world, path, hash_interval=10):
        water = frm.Water(world, nx=16, ny=16, border_cells=2)
        water.set_height([0.01] + [0.0] * 255)
        for _ in range(100):
            world.tick(0.002)
    with frm.Replay(context, path) as replay:
        assert sum(result.diverged for result in replay) == 0
        assert replay.world().hash() == world.hash()


def test_recording_of_a_process_that_died(context, tmp_path):
    world = frm.World(context)
    recorder = frm.Recorder(world, tmp_path / "torn.rec")
    for _ in range(200):
        world.tick(0.002)
    while recorder.stats().ticks < 200:  # until the writer has taken all
        time.sleep(0.001)
    torn = (tmp_path / "torn.rec.part").read_bytes()
    recorder.close()
    (tmp_path / "copy.rec").write_bytes(torn)
    with frm.Replay(context, tmp_path / "copy.rec") as replay:
        ticks = sum(1 for _ in replay)
        assert 200 - 21 <= ticks <= 200  # a frame is 40 ms
        assert replay.info().torn == 1


def test_recorder_comes_first(context, tmp_path):
    world = frm.World(context)
    world.tick(0.002)
    with pytest.raises(frm.Error) as caught:
        frm.Recorder(world, tmp_path / "late.rec")
    assert caught.value.status == frm.ERROR_STATE


def test_recorded_device(context, tmp_path):
    path = tmp_path / "device.rec"
    world = frm.World(context)
    device = frm.Device(context, Swing())
    with frm.Recorder(world, path) as recorder:
        recorder.add_device(device)
        recorded = []
        for tick in range(10):
            recorded.append(device.exchange(((tick * 0.1, 0, 0), (0, 0, 0))))
            world.tick(0.002)
    again = frm.Device.open_replay(context, path)
    for tick, state in enumerate(recorded):
        assert again.exchange() == state
        assert again.raw() == device_packet(tick)
    with pytest.raises(frm.Error) as caught:
        again.exchange()
    assert caught.value.status == frm.ERROR_END
    with pytest.raises(frm.Error) as caught:
        frm.Device.open_replay(context, path, 1)
    assert caught.value.status == frm.ERROR_STATE




def test_simulated_spidar_g(context):
    with frm.Device.open_simulated(context) as device:
        assert device.info().name == b"SpidarG6X3R (simulated)"
        state = device.exchange()
        assert state.faults == frm.DEVICE_FAULT_UNCALIBRATED and state.status == frm.DEVICE_UNCALIBRATED
        device.calibrate()
        device.set_safety(deadline_ns=10_000_000_000)
        device.engage()
        for _ in range(2500):
            state = device.exchange(((0, 0, 3), (0, 0, 0)))
        assert state.faults == 0 and state.status == frm.DEVICE_READY
        assert state.achieved.force.z == pytest.approx(3, abs=0.05)
        assert state.pose.position.z > 0.01


def test_spidar_g_configuration_errors(context, tmp_path):
    path = tmp_path / "device.json"
    path.write_text('{"format": "frm-spidar-g", "version": 1, "lever": -1}', encoding="utf-8")
    for function in (frm.Device.open_spidar_g, frm.Device.open_simulated, frm.Device.enumerate_spidar_g):
        with pytest.raises(frm.Error) as caught:
            function(context, path)
        assert caught.value.status == frm.ERROR_ARGUMENT and "lever" in str(caught.value)
    with pytest.raises(frm.Error) as caught:
        frm.Device.open_spidar_g(context, rotary=99)
    assert caught.value.status == frm.ERROR_ARGUMENT
