"""frm - the force of water on moving rigid objects, at haptic rates.

    import frm

    with frm.Context() as context:
        map = frm.Map(context, "paddle.frm")
        world = frm.World(context, density=1000)
        water = frm.Water(world, nx=200, ny=200, cell=0.025)
        body = frm.Body(world, map, mass=1.2)
        for _ in range(500):
            body.set_motion(((0, 0, -0.1), (0, 0, 0, 1)), ((0.5, 0, 0), (0, 0, 0)))
            world.tick(0.002)
            print(body.forces().total.force)

The C header include/frm.h is the manual; names, units (SI) and rules are the same here. Functions raise
`Error` instead of returning a status. Arrays of numbers may be given as anything; contiguous float32 buffers
(numpy, array('f')) are used without a copy. Arrays come back as numpy arrays where numpy can be imported,
else as array('f'), flat.

Calls release Python's lock. The header's thread tags hold: one thread at a time per context, except for
`Water.read_snapshot` and what a `Servo` says of itself, which any thread may call.
"""
from ._abi import (VERSION_MAJOR, VERSION_MINOR, VERSION_PATCH, AllocateFn, Axes, BodyDef, BodyState, Border,
                   Coefficients, ContextDef, DeviceCommand, DeviceDriver, DeviceFault, DeviceInfo, DeviceSafetyDef,
                   DeviceSafetyState, DeviceState, DeviceStatus, Forces, FreeFn, LogLevel, MapInfo, MapSource,
                   Model, Part, Pose, Position, Quaternion, RecorderDef, RecorderStats, ReplayInfo, ReplayStepResult,
                   ReplayTolerance, ServoDef, ServoInput, ServoState, ServoStats, ServoTickFn, ServoTime, Skip,
                   SourceState, Status, Surface, Twist, Vec3, WaterDef, WaterState, WorldDef, WorldStats, Wrench)
from . import _abi
from ._base import Context, Error, Object, version
from ._device import Device
from ._driver import Driver
from ._library import LibraryError, library
from ._recording import Recorder, Replay
from ._servo import Servo
from ._world import Body, Field, Map, Water, World

__version__ = f"{VERSION_MAJOR}.{VERSION_MINOR}.{VERSION_PATCH}"

Error.__module__ = __name__  # tracebacks name it as callers do

# Every enum value under its name in the header less FRM_: frm.MODEL_PAPER, frm.ERROR_END.
for _enum in _abi.ENUMS:
    globals().update(_enum.__members__)
del _enum

__all__ = [_name for _name in dir() if not _name.startswith("_")]
