"""include/frm.h as ctypes: its constants, enums, structs and functions, in the header's order.

Names follow one rule, which tests/python/test_parity.py enforces: an enum or struct ``frm_some_thing`` is
``SomeThing`` here, a constant ``FRM_NAME`` is ``NAME``, and a function keeps its name as a key of
`FUNCTIONS`. Handles are plain integers. What things mean, and their units, is said once: in the header.
"""
from __future__ import annotations

from ctypes import (CFUNCTYPE, POINTER, Structure, c_char, c_char_p, c_double, c_float, c_int32, c_uint8, c_uint32,
                    c_uint64, c_void_p, sizeof)
from enum import IntEnum

VERSION_MAJOR = 0
VERSION_MINOR = 1
VERSION_PATCH = 0


class Struct(Structure):
    """A struct of the header; `repr` shows the fields, `==` compares them."""

    @classmethod
    def sized(cls):
        """An empty one whose struct_size is set, for the library to fill."""
        return cls(struct_size=sizeof(cls))

    @classmethod
    def field_names(cls) -> list[str]:
        """The fields that say something: all but struct_size and padding."""
        return [name for name, *_ in cls._fields_ if name not in ("struct_size", "reserved", "reserved_2")]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{n}={getattr(self, n)!r}' for n in self.field_names())})"

    def __eq__(self, other) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return all(getattr(self, n) == getattr(other, n) for n in self.field_names())

    __hash__ = None


class Vector(Struct):
    """A struct of equal numbers: unpacks, indexes and has a length, as a tuple does."""

    def __iter__(self):
        return (getattr(self, name) for name, _ in self._fields_)

    def __len__(self) -> int:
        return len(self._fields_)

    def __getitem__(self, index):
        return tuple(self)[index]


def convert(kind, value):
    """`value` as the ctypes type `kind`: structs from any sequence of their fields, however deeply nested."""
    if not issubclass(kind, Structure) or isinstance(value, kind):
        return value
    fields = [field for field in kind._fields_ if field[0] not in ("struct_size", "reserved", "reserved_2")]
    values = tuple(value)
    if len(values) != len(fields):
        names = ", ".join(name for name, *_ in fields)
        raise TypeError(f"{kind.__name__} takes {len(fields)} values ({names}), not {len(values)}")
    made = kind.sized() if hasattr(kind, "struct_size") else kind()
    for (name, field_kind), item in zip(fields, values):
        setattr(made, name, convert(field_kind, item))
    return made


# ---- Status ------------------------------------------------------------------------------------------------

frm_status = c_int32


class Status(IntEnum):
    OK = 0
    ERROR_ARGUMENT = -1
    ERROR_HANDLE = -2
    ERROR_STATE = -3
    ERROR_VERSION = -4
    ERROR_MEMORY = -5
    ERROR_FILE = -6
    ERROR_CORRUPT = -7
    ERROR_CAPACITY = -8
    ERROR_LIMIT = -9
    ERROR_DEVICE = -10
    ERROR_END = -11
    ERROR_INTERNAL = -12
    ERROR_DIVERGED = -13
    ERROR_UNSUPPORTED = -14


# ---- Handles and plain values ------------------------------------------------------------------------------

frm_context = frm_map = frm_world = frm_water = frm_body = frm_device = frm_recorder = frm_replay = frm_servo = c_uint64


class Vec3(Vector):
    _fields_ = [("x", c_float), ("y", c_float), ("z", c_float)]


class Position(Vector):
    _fields_ = [("x", c_double), ("y", c_double), ("z", c_double)]


class Quaternion(Vector):
    _fields_ = [("x", c_float), ("y", c_float), ("z", c_float), ("w", c_float)]


class Pose(Struct):
    _fields_ = [("position", Position), ("rotation", Quaternion)]


class Twist(Struct):
    _fields_ = [("linear", Vec3), ("angular", Vec3)]


class Wrench(Struct):
    _fields_ = [("force", Vec3), ("torque", Vec3)]


# ---- Context -----------------------------------------------------------------------------------------------

class Axes(IntEnum):
    AXES_Z_UP_RIGHT = 0
    AXES_Y_UP_RIGHT = 1
    AXES_Y_UP_LEFT = 2
    AXES_Z_UP_LEFT = 3


class LogLevel(IntEnum):
    LOG_ERROR = 0
    LOG_WARNING = 1
    LOG_INFO = 2


AllocateFn = CFUNCTYPE(c_void_p, c_void_p, c_uint64, c_uint64)
FreeFn = CFUNCTYPE(None, c_void_p, c_void_p, c_uint64, c_uint64)


class ContextDef(Struct):
    _fields_ = [("struct_size", c_uint32), ("axes", c_uint32), ("threads", c_uint32),
                ("log_capacity", c_uint32), ("allocate", AllocateFn), ("release", FreeFn),
                ("allocator_user", c_void_p)]


# ---- Map ---------------------------------------------------------------------------------------------------

class MapInfo(Struct):
    _fields_ = [("struct_size", c_uint32), ("format_version", c_uint32), ("file_bytes", c_uint64),
                ("content_hash", c_uint64), ("sources", c_uint32), ("directions", c_uint32),
                ("samples", c_uint32), ("triangles", c_uint32), ("period", c_float), ("base_speed", c_float),
                ("density", c_float), ("viscosity", c_float), ("reynolds", c_float),
                ("reynolds_solved", c_float), ("reference_length", c_float), ("quantisation_error", c_float),
                ("area", c_float), ("volume", c_float), ("centroid", Vec3), ("bounds_low", Vec3),
                ("bounds_high", Vec3), ("reserved", c_uint32), ("fluctuation_directions", c_uint32),
                ("speeds", c_uint32), ("has_spin", c_uint32), ("has_added_mass", c_uint32),
                ("direction_error_rms", c_float), ("direction_error_worst", c_float),
                ("uncertainty", c_float), ("reserved_2", c_uint32)]


class MapSource(Struct):
    _fields_ = [("struct_size", c_uint32), ("area", c_float), ("position", Vec3), ("normal", Vec3)]


# ---- World -------------------------------------------------------------------------------------------------

class Model(IntEnum):
    MODEL_PAPER = 0
    MODEL_DISPLACEMENT = 1
    MODEL_OWN_WAVES = 2
    MODEL_FLUCTUATION = 4
    MODEL_SPEEDS = 8
    MODEL_SPIN = 16
    MODEL_DEFAULT = 31


class Skip(IntEnum):
    SKIP_NOTHING = 0
    SKIP_FRICTION = 1
    SKIP_STEADY = 2
    SKIP_DRY_BODIES = 4
    SKIP_WET_BODIES = 8
    SKIP_CALM_WATER = 16
    SKIP_WAVE_STEPS = 32
    SKIP_DEEP_BODIES = 64
    SKIP_STILL_BODIES = 128
    SKIP_DEFAULT = 255


class Surface(IntEnum):
    SURFACE_FLAT = 0
    SURFACE_NONE = 1


class WorldDef(Struct):
    _fields_ = [("struct_size", c_uint32), ("model", c_uint32), ("surface", c_uint32), ("gravity", c_float),
                ("density", c_float), ("viscosity", c_float), ("level", c_double), ("skip", c_uint32),
                ("error_budget", c_float), ("time_budget", c_float), ("reserved", c_uint32)]


class WorldStats(Struct):
    _fields_ = [("struct_size", c_uint32), ("bodies", c_uint32), ("ticks", c_uint64), ("time", c_double),
                ("wet_bodies", c_uint32), ("wet_sources", c_uint32), ("clipped_triangles", c_uint32),
                ("water_substeps", c_uint32), ("dry_bodies", c_uint32), ("whole_bodies", c_uint32),
                ("still_bodies", c_uint32), ("deep_bodies", c_uint32), ("coarse_bodies", c_uint32),
                ("frictionless_sources", c_uint32), ("steady_sources", c_uint32), ("active_cells", c_uint32),
                ("water_waits", c_uint64), ("over_budget_bodies", c_uint32), ("reserved", c_uint32)]


# ---- Water -------------------------------------------------------------------------------------------------

class Border(IntEnum):
    BORDER_ABSORBING = 0
    BORDER_REFLECTING = 1


class WaterDef(Struct):
    _fields_ = [("struct_size", c_uint32), ("nx", c_uint32), ("ny", c_uint32), ("border", c_uint32),
                ("border_cells", c_uint32), ("cell", c_float), ("depth", c_float),
                ("snapshot_interval", c_float), ("centre_x", c_double), ("centre_y", c_double),
                ("order", c_uint32), ("reserved", c_uint32)]


class WaterState(Struct):
    _fields_ = [("struct_size", c_uint32), ("nx", c_uint32), ("ny", c_uint32), ("reserved", c_uint32),
                ("capacity", c_uint64), ("tick", c_uint64), ("time", c_double), ("height", POINTER(c_float)),
                ("velocity_x", POINTER(c_float)), ("velocity_y", POINTER(c_float))]


# ---- Body --------------------------------------------------------------------------------------------------

class BodyDef(Struct):
    _fields_ = [("struct_size", c_uint32), ("scale", c_float), ("map", frm_map), ("mass", c_float),
                ("centre_of_mass", Vec3), ("pose", Pose), ("twist", Twist)]


class Forces(Struct):
    _fields_ = [("struct_size", c_uint32), ("reserved", c_uint32), ("total", Wrench), ("buoyancy", Wrench),
                ("pressure", Wrench), ("friction", Wrench), ("gravity", Wrench)]


class BodyState(Struct):
    _fields_ = [("struct_size", c_uint32), ("wet_area", c_float), ("displaced_volume", c_float),
                ("relative_speed", c_float), ("reynolds", c_float), ("wet_sources", c_uint32), ("pose", Pose),
                ("twist", Twist)]


class Coefficients(Struct):
    _fields_ = [("struct_size", c_uint32), ("wet_share", c_float), ("added_mass", c_double * 36),
                ("damping", c_double * 36)]


class SourceState(Struct):
    _fields_ = [("position", Position), ("force", Vec3), ("relative_velocity", Vec3), ("wet_ratio", c_float),
                ("map_time", c_float)]


# ---- Device ------------------------------------------------------------------------------------------------

class DeviceStatus(IntEnum):
    DEVICE_READY = 0
    DEVICE_UNCALIBRATED = 1
    DEVICE_FAULT = 2


class DeviceFault(IntEnum):
    DEVICE_FAULT_NONE = 0
    DEVICE_FAULT_UNCALIBRATED = 1
    DEVICE_FAULT_SHORT_PACKET = 2
    DEVICE_FAULT_TIMEOUT = 4
    DEVICE_FAULT_TRANSFER = 8
    DEVICE_FAULT_UNPLUGGED = 16
    DEVICE_FAULT_LOST_COUNT = 32
    DEVICE_FAULT_STUCK_ENCODER = 64
    DEVICE_FAULT_SLACK_STRING = 128
    DEVICE_FAULT_BROKEN_STRING = 256
    DEVICE_FAULT_DEADLINE = 512
    DEVICE_FAULT_COMMAND = 65536
    DEVICE_FAULT_STEP = 131072
    DEVICE_FAULT_SPEED = 262144
    DEVICE_FAULT_STATE = 1048576
    DEVICE_FAULT_JUMP = 2097152
    DEVICE_FAULT_STALE = 4194304
    DEVICE_FAULT_DRIVER = 8388608


class DeviceInfo(Struct):
    _fields_ = [("struct_size", c_uint32), ("serial", c_uint32), ("max_force", c_float),
                ("max_torque", c_float), ("period_ns", c_uint64), ("name", c_char * 64)]


class DeviceCommand(Struct):
    _fields_ = [("struct_size", c_uint32), ("reserved", c_uint32), ("wrench", Wrench),
                ("deadline_ns", c_uint64)]


class DeviceState(Struct):
    _fields_ = [("struct_size", c_uint32), ("status", c_uint32), ("pose", Pose), ("twist", Twist),
                ("grip", c_float), ("buttons", c_uint32), ("time_ns", c_uint64), ("sequence", c_uint64),
                ("achieved", Wrench), ("faults", c_uint32), ("reserved", c_uint32)]


class DeviceDriver(Struct):
    _fields_ = [
        ("struct_size", c_uint32), ("reserved", c_uint32),
        ("enumerate", CFUNCTYPE(frm_status, c_void_p, POINTER(DeviceInfo), c_uint32, POINTER(c_uint32))),
        ("open", CFUNCTYPE(frm_status, c_void_p, c_uint32, POINTER(c_void_p))),
        ("close", CFUNCTYPE(frm_status, c_void_p, c_void_p)),
        ("info", CFUNCTYPE(frm_status, c_void_p, c_void_p, POINTER(DeviceInfo))),
        ("calibrate", CFUNCTYPE(frm_status, c_void_p, c_void_p)),
        ("exchange", CFUNCTYPE(frm_status, c_void_p, c_void_p, POINTER(DeviceCommand), POINTER(DeviceState))),
        ("stop", CFUNCTYPE(frm_status, c_void_p, c_void_p)),
        ("raw", CFUNCTYPE(frm_status, c_void_p, c_void_p, POINTER(c_uint8), c_uint32, POINTER(c_uint32))),
    ]


# ---- Safety ------------------------------------------------------------------------------------------------

class DeviceSafetyDef(Struct):
    _fields_ = [("struct_size", c_uint32), ("passivity", c_uint32), ("max_force", c_float),
                ("max_torque", c_float), ("slew_time", c_float), ("ramp_time", c_float),
                ("max_step", c_float), ("max_speed", c_float), ("max_spin", c_float),
                ("brake_time", c_float), ("grip_mass", c_float), ("grip_inertia", c_float),
                ("energy_reserve", c_float), ("quick_time", c_float), ("dead_band", c_float),
                ("spin_dead_band", c_float), ("max_stale", c_uint32), ("dead_man_buttons", c_uint32),
                ("dead_man_grip", c_float), ("reserved", c_uint32), ("deadline_ns", c_uint64)]


class DeviceSafetyState(Struct):
    _fields_ = [("struct_size", c_uint32), ("engaged", c_uint32), ("faults", c_uint32), ("ramp", c_float),
                ("sent", Wrench), ("energy", c_float), ("spin_energy", c_float), ("damping", c_float),
                ("spin_damping", c_float), ("quick_gain", c_float), ("quick_spin_gain", c_float),
                ("limited", c_uint64), ("damped", c_uint64), ("fault_count", c_uint64),
                ("reason", c_char * 128)]


# ---- Servo -------------------------------------------------------------------------------------------------

ServoTickFn = CFUNCTYPE(frm_status, c_void_p, c_uint64, c_float)


class ServoDef(Struct):
    _fields_ = [("struct_size", c_uint32), ("rate", c_uint32), ("device", frm_device), ("body", frm_body),
                ("grip", Pose), ("priority", c_uint32), ("lock_memory", c_uint32), ("on_tick", ServoTickFn),
                ("user", c_void_p)]


class ServoInput(Struct):
    _fields_ = [("struct_size", c_uint32), ("motion_scale", c_float), ("force_scale", c_float),
                ("torque_scale", c_float), ("anchor", Pose), ("extra", Wrench)]


class ServoState(Struct):
    _fields_ = [("struct_size", c_uint32), ("running", c_uint32), ("ticks", c_uint64), ("time", c_double),
                ("pose", Pose), ("twist", Twist), ("wrench", Wrench), ("displayed", Wrench),
                ("grip_pose", Pose), ("grip", c_float), ("buttons", c_uint32), ("device_status", c_uint32),
                ("engaged", c_uint32), ("faults", c_uint32), ("ramp", c_float), ("energy", c_float),
                ("status", c_int32), ("reason", c_char * 128)]


class ServoStats(Struct):
    _fields_ = [("struct_size", c_uint32), ("realtime", c_uint32), ("period_ns", c_uint64),
                ("ticks", c_uint64), ("missed", c_uint64), ("skipped", c_uint64),
                ("failed_exchanges", c_uint64), ("diverged", c_uint64), ("tick_p50", c_uint64),
                ("tick_p99", c_uint64), ("tick_p9999", c_uint64), ("tick_max", c_uint64),
                ("late_p50", c_uint64), ("late_p99", c_uint64), ("late_p9999", c_uint64),
                ("late_max", c_uint64), ("memory_locked", c_uint32), ("reserved", c_uint32)]


class ServoTime(IntEnum):
    SERVO_TICK = 0
    SERVO_LATE = 1


# ---- Recorder and replay -----------------------------------------------------------------------------------

class RecorderDef(Struct):
    _fields_ = [("struct_size", c_uint32), ("hash_interval", c_uint32), ("queue_bytes", c_uint32),
                ("waits", c_uint32), ("force_interval", c_uint32)]


class RecorderStats(Struct):
    _fields_ = [("struct_size", c_uint32), ("reserved", c_uint32), ("ticks", c_uint64), ("lost_events", c_uint64),
                ("file_bytes", c_uint64), ("queue_bytes", c_uint64), ("queue_most", c_uint64)]


class ReplayInfo(Struct):
    _fields_ = [("struct_size", c_uint32), ("torn", c_uint32), ("ticks", c_uint64), ("time", c_double),
                ("bodies", c_uint32), ("devices", c_uint32), ("has_water", c_uint32), ("maps", c_uint32),
                ("lost_events", c_uint64)]


class ReplayTolerance(Struct):
    _fields_ = [("struct_size", c_uint32), ("relative", c_float), ("force", c_float), ("torque", c_float)]


class Part(IntEnum):
    PART_NONE = 0
    PART_BUOYANCY = 1
    PART_PRESSURE = 2
    PART_FRICTION = 3
    PART_GRAVITY = 4
    PART_TOTAL = 5
    PART_WORLD = 6


class ReplayStepResult(Struct):
    _fields_ = [("struct_size", c_uint32), ("diverged", c_uint32), ("tick", c_uint64), ("body", c_uint32),
                ("part", c_uint32), ("time", c_double), ("component", c_uint32), ("recorded", c_float),
                ("replayed", c_float), ("reserved", c_uint32)]


# ---- The tables --------------------------------------------------------------------------------------------

ENUMS = (Status, Axes, LogLevel, Model, Skip, Surface, Border, DeviceStatus, DeviceFault, ServoTime, Part)

STRUCTS = (Vec3, Position, Quaternion, Pose, Twist, Wrench, ContextDef, MapInfo, MapSource, WorldDef,
           WorldStats, WaterDef, WaterState, BodyDef, Forces, BodyState, Coefficients, SourceState, DeviceInfo,
           DeviceCommand, DeviceState, DeviceDriver, DeviceSafetyDef, DeviceSafetyState, ServoDef,
           ServoInput, ServoState, ServoStats, RecorderDef, RecorderStats, ReplayInfo, ReplayTolerance,
           ReplayStepResult)

_text = POINTER(c_char)
_u32 = POINTER(c_uint32)
_u64 = POINTER(c_uint64)
_floats = POINTER(c_float)
_handle = POINTER(c_uint64)

# name: (what it returns, what it takes)
FUNCTIONS = {
    "frm_status_name": (c_char_p, (frm_status,)),
    "frm_version": (frm_status, (_u32, _u32, _u32)),

    "frm_context_def_init": (frm_status, (POINTER(ContextDef), c_uint64)),
    "frm_context_create": (frm_status, (POINTER(ContextDef), _handle)),
    "frm_context_destroy": (frm_status, (frm_context,)),
    "frm_context_last_error": (frm_status, (frm_context, _text, c_uint64, _u64)),
    "frm_context_poll_log": (frm_status, (frm_context, _u32, _text, c_uint64, _u64)),

    "frm_map_open_file": (frm_status, (frm_context, c_char_p, _handle)),
    "frm_map_open_memory": (frm_status, (frm_context, c_void_p, c_uint64, _handle)),
    "frm_map_close": (frm_status, (frm_map,)),
    "frm_map_get_info": (frm_status, (frm_map, POINTER(MapInfo))),
    "frm_map_get_source": (frm_status, (frm_map, c_uint32, POINTER(MapSource))),
    "frm_map_get_provenance": (frm_status, (frm_map, _text, c_uint64, _u64)),
    "frm_map_get_added_mass": (frm_status, (frm_map, c_float, c_float, POINTER(c_double))),

    "frm_world_def_init": (frm_status, (POINTER(WorldDef), c_uint64)),
    "frm_world_create": (frm_status, (frm_context, POINTER(WorldDef), _handle)),
    "frm_world_get_def": (frm_status, (frm_world, POINTER(WorldDef))),
    "frm_world_destroy": (frm_status, (frm_world,)),
    "frm_world_tick": (frm_status, (frm_world, c_float)),
    "frm_world_get_stats": (frm_status, (frm_world, POINTER(WorldStats))),
    "frm_world_hash": (frm_status, (frm_world, _u64)),

    "frm_water_def_init": (frm_status, (POINTER(WaterDef), c_uint64)),
    "frm_water_create": (frm_status, (frm_world, POINTER(WaterDef), _handle)),
    "frm_water_destroy": (frm_status, (frm_water,)),
    "frm_water_get_def": (frm_status, (frm_water, POINTER(WaterDef))),
    "frm_water_read": (frm_status, (frm_water, POINTER(WaterState))),
    "frm_water_read_snapshot": (frm_status, (frm_water, POINTER(WaterState))),
    "frm_water_set_height": (frm_status, (frm_water, _floats, c_uint64)),
    "frm_water_set_pressure": (frm_status, (frm_water, _floats, c_uint64)),
    "frm_water_get_height": (frm_status, (frm_water, c_double, c_double, POINTER(c_double))),

    "frm_body_def_init": (frm_status, (POINTER(BodyDef), c_uint64)),
    "frm_body_create": (frm_status, (frm_world, POINTER(BodyDef), _handle)),
    "frm_body_get_def": (frm_status, (frm_body, POINTER(BodyDef))),
    "frm_body_destroy": (frm_status, (frm_body,)),
    "frm_body_set_motion": (frm_status, (frm_body, POINTER(Pose), POINTER(Twist))),
    "frm_body_get_forces": (frm_status, (frm_body, POINTER(Forces))),
    "frm_body_get_state": (frm_status, (frm_body, POINTER(BodyState))),
    "frm_body_get_coefficients": (frm_status, (frm_body, POINTER(Coefficients))),
    "frm_body_get_sources": (frm_status, (frm_body, POINTER(SourceState), c_uint32, _u32)),

    "frm_device_enumerate": (frm_status, (frm_context, POINTER(DeviceDriver), c_void_p, POINTER(DeviceInfo),
                                          c_uint32, _u32)),
    "frm_device_open": (frm_status, (frm_context, POINTER(DeviceDriver), c_void_p, c_uint32, _handle)),
    "frm_device_open_null": (frm_status, (frm_context, _handle)),
    "frm_device_open_replay": (frm_status, (frm_context, c_char_p, c_uint32, _handle)),
    "frm_device_enumerate_spidar_g": (frm_status, (frm_context, c_char_p, POINTER(DeviceInfo), c_uint32,
                                                    _u32)),
    "frm_device_open_spidar_g": (frm_status, (frm_context, c_char_p, c_int32, _handle)),
    "frm_device_open_simulated": (frm_status, (frm_context, c_char_p, _handle)),
    "frm_device_close": (frm_status, (frm_device,)),
    "frm_device_get_info": (frm_status, (frm_device, POINTER(DeviceInfo))),
    "frm_device_calibrate": (frm_status, (frm_device,)),
    "frm_device_exchange": (frm_status, (frm_device, POINTER(DeviceCommand), POINTER(DeviceState))),
    "frm_device_get_raw": (frm_status, (frm_device, POINTER(c_uint8), c_uint32, _u32)),
    "frm_device_stop": (frm_status, (frm_device,)),

    "frm_device_safety_def_init": (frm_status, (POINTER(DeviceSafetyDef), c_uint64)),
    "frm_device_set_safety": (frm_status, (frm_device, POINTER(DeviceSafetyDef))),
    "frm_device_get_safety": (frm_status, (frm_device, POINTER(DeviceSafetyState))),
    "frm_device_engage": (frm_status, (frm_device,)),
    "frm_device_disengage": (frm_status, (frm_device,)),
    "frm_device_clear_fault": (frm_status, (frm_device,)),

    "frm_servo_def_init": (frm_status, (POINTER(ServoDef), c_uint64)),
    "frm_servo_input_init": (frm_status, (POINTER(ServoInput), c_uint64)),
    "frm_servo_create": (frm_status, (frm_context, POINTER(ServoDef), _handle)),
    "frm_servo_destroy": (frm_status, (frm_servo,)),
    "frm_servo_start": (frm_status, (frm_servo,)),
    "frm_servo_stop": (frm_status, (frm_servo,)),
    "frm_servo_set_input": (frm_status, (frm_servo, POINTER(ServoInput))),
    "frm_servo_engage": (frm_status, (frm_servo,)),
    "frm_servo_disengage": (frm_status, (frm_servo,)),
    "frm_servo_clear_fault": (frm_status, (frm_servo,)),
    "frm_servo_get_state": (frm_status, (frm_servo, POINTER(ServoState))),
    "frm_servo_get_stats": (frm_status, (frm_servo, POINTER(ServoStats))),
    "frm_servo_get_histogram": (frm_status, (frm_servo, c_uint32, _u64, _u64, c_uint32, _u32)),

    "frm_recorder_def_init": (frm_status, (POINTER(RecorderDef), c_uint64)),
    "frm_recorder_create": (frm_status, (frm_world, c_char_p, POINTER(RecorderDef), _handle)),
    "frm_recorder_add_device": (frm_status, (frm_recorder, frm_device)),
    "frm_recorder_get_stats": (frm_status, (frm_recorder, POINTER(RecorderStats))),
    "frm_recorder_close": (frm_status, (frm_recorder,)),
    "frm_replay_open": (frm_status, (frm_context, c_char_p, _handle)),
    "frm_replay_close": (frm_status, (frm_replay,)),
    "frm_replay_get_info": (frm_status, (frm_replay, POINTER(ReplayInfo))),
    "frm_replay_set_tolerance": (frm_status, (frm_replay, POINTER(ReplayTolerance))),
    "frm_replay_step": (frm_status, (frm_replay, POINTER(ReplayStepResult))),
    "frm_replay_get_world": (frm_status, (frm_replay, _handle)),
    "frm_replay_get_water": (frm_status, (frm_replay, _handle)),
    "frm_replay_get_body": (frm_status, (frm_replay, c_uint32, _handle)),
    "frm_replay_get_map": (frm_status, (frm_replay, c_uint32, _handle)),
}
