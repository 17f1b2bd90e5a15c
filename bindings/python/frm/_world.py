"""Maps, worlds, water and bodies."""
from __future__ import annotations

import ctypes
from ctypes import byref, c_double, c_float, c_uint32
from typing import NamedTuple

from . import _abi, _buffers
from ._abi import (BodyDef, BodyState, Coefficients, Forces, MapInfo, MapSource, Pose, SourceState, Twist, WaterDef,
                   WaterState, WorldDef, WorldStats)
from ._base import Context, Error, Object, definition_of, two_calls, utf8, wrap


class Map(Object):
    """A map file, read whole and checked."""

    _close_function = "frm_map_close"

    def __init__(self, context: Context, path):
        super().__init__(context, context._made(context._lib.frm_map_open_file, context.handle, utf8(path)))

    @classmethod
    def open_memory(cls, context: Context, data) -> "Map":
        """From a map file's bytes, which are copied."""
        data = bytes(data)
        handle = context._made(context._lib.frm_map_open_memory, context.handle, data, len(data))
        return wrap(cls, context, handle)

    def info(self) -> MapInfo:
        """What the map holds; SI units, as frm_map_info says."""
        return self._filled(MapInfo, self._lib.frm_map_get_info)

    def source(self, index: int) -> MapSource:
        """One haptic source: area (m^2), position (m) and normal in the body's frame at scale 1."""
        return self._filled(MapSource, lambda handle, out: self._lib.frm_map_get_source(handle, index, out))

    def added_mass(self, density: float = 1000.0, scale: float = 1.0) -> list[list[float]]:
        """Six rows of six: force x, y, z, torque x, y, z; kg, kg m, kg m^2. For a body of this scale in a fluid of this
        density (kg/m^3). An Error with status ERROR_STATE if the map was made without."""
        matrix = (c_double * 36)()
        self._check(self._lib.frm_map_get_added_mass(self.handle, density, scale, matrix))
        return [list(matrix[6 * row:6 * row + 6]) for row in range(6)]

    def provenance(self) -> str:
        """How the map was made, as JSON text."""
        status, text = two_calls(lambda *a: self._lib.frm_map_get_provenance(self.handle, *a))
        self._check(status)
        return text.decode("utf-8")


class World(Object):
    """Bodies and at most one water.

    Options: model, surface, gravity (m/s^2), density (kg/m^3), viscosity (m^2/s), level (m), skip,
    error_budget (N), time_budget (us).
    """

    _close_function = "frm_world_destroy"

    def __init__(self, context: Context, **options):
        lib = context._lib
        definition = definition_of(WorldDef, lib.frm_world_def_init, "World", options)
        super().__init__(context, context._made(lib.frm_world_create, context.handle, byref(definition)))

    def definition(self) -> WorldDef:
        """The world's settings, as made (frm_world_get_def)."""
        return self._filled(WorldDef, self._lib.frm_world_get_def)

    def tick(self, dt: float) -> None:
        """Advances the world by dt seconds, 1e-6 to 0.1."""
        if status := self._lib.frm_world_tick(self.handle, dt):
            raise self._error(status)

    def stats(self) -> WorldStats:
        """Counters; time in s."""
        return self._filled(WorldStats, self._lib.frm_world_get_stats)

    def hash(self) -> int:
        """A 64-bit hash of everything that decides the world's future."""
        return self._made(self._lib.frm_world_hash, self.handle)


class Field(NamedTuple):
    """The water's field: what frm_water_state holds. Arrays that were not asked for are None.

    With numpy an array has the shape (ny, nx): field.height[j, i]. Without, it is a flat array('f'): cell
    (i, j) is at j * nx + i.
    """
    nx: int
    ny: int
    tick: int
    time: float  # s
    height: object  # above the calm level, m
    velocity_x: object  # along the first horizontal axis, m/s
    velocity_y: object  # along the second, m/s


class Water(Object):
    """A height field with waves.

    Options: nx, ny, border, border_cells, cell (m), depth (m), snapshot_interval (s), centre_x (m) and
    centre_y (m).
    """

    _close_function = "frm_water_destroy"

    def __init__(self, world: World, **options):
        lib = world._lib
        definition = definition_of(WaterDef, lib.frm_water_def_init, "Water", options)
        super().__init__(world.context, world._made(lib.frm_water_create, world.handle, byref(definition)))
        self._size = definition.nx, definition.ny

    def definition(self) -> WaterDef:
        """The water's size, as made (frm_water_get_def)."""
        return self._filled(WaterDef, self._lib.frm_water_get_def)

    def read(self, height=True, velocity_x=False, velocity_y=False) -> Field:
        """The field as it is now.

        Each argument: True for a new array, a writable float32 buffer to be filled, or False for none.
        """
        status, field = self._read(self._lib.frm_water_read, height, velocity_x, velocity_y)
        self._check(status)
        return field

    def read_snapshot(self, height=True, velocity_x=False, velocity_y=False) -> Field:
        """The newest snapshot, as `read`; from any thread, also while another ticks the world."""
        status, field = self._read(self._lib.frm_water_read_snapshot, height, velocity_x, velocity_y)
        if status:
            # The last-error text belongs to the owner's thread, and this may be another.
            raise Error(status, "" if self.handle else "the Water is closed")
        return field

    def _read(self, function, *wanted) -> tuple[int, Field]:
        nx, ny = self._size
        arrays = [_buffers.new_floats(ny, nx) if want is True else want if want is not False else None
                  for want in wanted]
        pointers = [None if array is None else _buffers.writable(array) for array in arrays]
        state = WaterState.sized()
        state.capacity = min((len(pointer) for pointer in pointers if pointer is not None), default=0)
        for name, pointer in zip(("height", "velocity_x", "velocity_y"), pointers):
            if pointer is not None:
                setattr(state, name, ctypes.cast(pointer, ctypes.POINTER(c_float)))
        status = function(self.handle, byref(state))
        return status, Field(state.nx, state.ny, state.tick, state.time, *arrays)

    def set_height(self, height) -> None:
        """Sets heights (m, nx * ny numbers, row after row) and lets the water rest."""
        values, count = _buffers.floats_in(height)
        self._check(self._lib.frm_water_set_height(self.handle, values, count))

    def set_pressure(self, pressure) -> None:
        """Sets a pressure (Pa, nx * ny numbers) that pushes up on the surface; None takes it away."""
        values, count = (None, 0) if pressure is None else _buffers.floats_in(pressure)
        self._check(self._lib.frm_water_set_pressure(self.handle, values, count))

    def height(self, x: float, y: float) -> float:
        """Height of the surface (m, in the world) at a horizontal position (m)."""
        height = c_double()
        self._check(self._lib.frm_water_get_height(self.handle, x, y, byref(height)))
        return height.value


class Body(Object):
    """A map in a world. Options: scale, mass (kg), centre_of_mass (m), pose, twist."""

    _close_function = "frm_body_destroy"

    def __init__(self, world: World, map: Map, **options):
        lib = world._lib
        definition = definition_of(BodyDef, lib.frm_body_def_init, "Body", {**options, "map": map.handle})
        super().__init__(world.context, world._made(lib.frm_body_create, world.handle, byref(definition)))

    def set_motion(self, pose, twist=None) -> None:
        """Pose ((x, y, z) m, (x, y, z, w)) and twist (m/s, rad/s; None: at rest) from the next tick on."""
        pose = _abi.convert(Pose, pose)
        twist = None if twist is None else byref(_abi.convert(Twist, twist))
        if status := self._lib.frm_body_set_motion(self.handle, byref(pose), twist):
            raise self._error(status)

    def definition(self) -> BodyDef:
        """Map, scale, mass, centre of mass as made; pose and twist as last set (frm_body_get_def)."""
        return self._filled(BodyDef, self._lib.frm_body_get_def)

    def forces(self) -> Forces:
        """The wrenches of the last tick, N and N m about the body's origin."""
        return self._filled(Forces, self._lib.frm_body_get_forces)

    def state(self) -> BodyState:
        """How wet the body is, and how fast it goes through the water."""
        return self._filled(BodyState, self._lib.frm_body_get_state)

    def coefficients(self) -> Coefficients:
        """Added mass and damping at the last tick, each 36 numbers, row after row: solve (M + added_mass + dt damping) dv =
        dt F for the change of velocity and angular velocity of a body that floats (samples/float.py)."""
        return self._filled(Coefficients, self._lib.frm_body_get_coefficients)

    def sources(self):
        """The sources after the last tick, in the world frame.

        With numpy a structured array, sources["force"][:, 2]; without, an array of SourceState. Position (m),
        force (N), relative_velocity (m/s), wet_ratio, map_time (s).
        """
        count = c_uint32()
        self._check(self._lib.frm_body_get_sources(self.handle, None, 0, byref(count)))
        sources = (SourceState * count.value)()
        self._check(self._lib.frm_body_get_sources(self.handle, sources, count.value, byref(count)))
        return _buffers.structs_out(sources)
