"""Recorders, and replays that compare bit for bit."""
from __future__ import annotations

from ctypes import byref
from typing import Iterator

from ._abi import RecorderDef, RecorderStats, ReplayInfo, ReplayStepResult, ReplayTolerance, Status
from ._base import Context, Error, Object, definition_of, utf8, wrap
from ._device import Device
from ._world import Body, Map, Water, World


class Recorder(Object):
    """Records what a world is told and what it answers.

    Options: hash_interval and force_interval (ticks), queue_bytes, waits (True: lose nothing, and let calls wait).
    """

    _close_function = "frm_recorder_close"

    def __init__(self, world: World, path, **options):
        lib = world._lib
        definition = definition_of(RecorderDef, lib.frm_recorder_def_init, "Recorder", options)
        super().__init__(world.context,
                         world._made(lib.frm_recorder_create, world.handle, utf8(path), byref(definition)))

    def add_device(self, device: Device) -> None:
        """Records every exchange of this device too."""
        self._check(self._lib.frm_recorder_add_device(self.handle, device.handle))

    def stats(self) -> RecorderStats:
        """How it goes: ticks, bytes, and events that were lost."""
        return self._filled(RecorderStats, self._lib.frm_recorder_get_stats)

    def close(self) -> None:
        """Writes what is left and gives the file its name; an Error if a write failed since the start, or if events
        were lost."""
        try:
            super().close()
        finally:
            self.handle = 0


class Replay(Object):
    """Replays a recording in a world of its own and compares bit for bit. Iterating steps to the end."""

    _close_function = "frm_replay_close"

    def __init__(self, context: Context, path):
        super().__init__(context, context._made(context._lib.frm_replay_open, context.handle, utf8(path)))

    def info(self) -> ReplayInfo:
        """What the recording holds; time in s."""
        return self._filled(ReplayInfo, self._lib.frm_replay_get_info)

    def set_tolerance(self, relative: float = 0, force: float = 0, torque: float = 0) -> None:
        """How far a result may be off: relative to the body's largest force (torque) in the recording, and in N and
        N m besides. All 0: not by a bit."""
        tolerance = ReplayTolerance.sized()
        tolerance.relative, tolerance.force, tolerance.torque = relative, force, torque
        self._check(self._lib.frm_replay_set_tolerance(self.handle, byref(tolerance)))

    def step(self) -> ReplayStepResult:
        """Replays the next tick; after the last an Error with the status ERROR_END."""
        return self._filled(ReplayStepResult, self._lib.frm_replay_step)

    def __iter__(self) -> Iterator[ReplayStepResult]:
        while True:
            try:
                result = self.step()
            except Error as error:
                if error.status == Status.ERROR_END:
                    return
                raise
            yield result

    # The replay's own objects: to look at, not to change. Closing one only lets go of it.

    def world(self) -> World:
        return self._borrowed(World, self._lib.frm_replay_get_world)

    def water(self) -> Water:
        """An Error with the status ERROR_STATE while there is none."""
        water = self._borrowed(Water, self._lib.frm_replay_get_water)
        definition = water.definition()
        water._size = definition.nx, definition.ny
        return water

    def body(self, index: int) -> Body:
        """In order of creation; an Error with the status ERROR_STATE if it is not there now."""
        return self._borrowed(Body, self._lib.frm_replay_get_body, index)

    def map(self, index: int) -> Map:
        return self._borrowed(Map, self._lib.frm_replay_get_map, index)

    def _borrowed(self, cls, function, *arguments):
        return wrap(cls, self.context, self._made(function, self.handle, *arguments), owned=False)
