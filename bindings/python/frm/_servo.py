"""The servo: a thread of the library that closes the loop between a device and a body."""
from __future__ import annotations

from ctypes import byref, c_uint32, c_uint64

from . import _abi
from ._abi import ServoDef, ServoInput, ServoState, ServoStats, ServoTime
from ._base import Context, Object, definition_of


class Servo(Object):
    """Ticks the body's world at its own rate, with the device's grip as the body's motion.

    Options: rate, grip, priority, lock_memory, on_tick, user. While it runs, other calls that touch the world or the
    device raise FRM_ERROR_STATE. A driver or on_tick in Python runs on the servo's thread and takes Python's lock in
    every tick: good for a hundred hertz, not for a kilohertz.
    """

    _close_function = "frm_servo_destroy"

    def __init__(self, context: Context, device, body, **options):
        options.update(device=device.handle, body=body.handle)
        definition = definition_of(ServoDef, context._lib.frm_servo_def_init, "Servo", options)
        handle = context._made(context._lib.frm_servo_create, context.handle, byref(definition))
        super().__init__(context, handle)
        context._callbacks[handle] = definition
        self._input = definition_of(ServoInput, self._lib.frm_servo_input_init, "Servo", {})

    def close(self) -> None:
        """Stops it and destroys it. Calling it again does nothing."""
        handle = self.handle
        super().close()
        self.context._callbacks.pop(handle, None)

    def start(self) -> None:
        """Starts its thread."""
        self._check(self._lib.frm_servo_start(self.handle))

    def stop(self) -> None:
        """Ends its thread; the device is disengaged and stopped."""
        self._check(self._lib.frm_servo_stop(self.handle))

    def set_input(self, **options) -> None:
        """From its next tick on; what is not named stays: motion_scale, force_scale, torque_scale, anchor, extra."""
        kinds = dict(ServoInput._fields_)
        for name, value in options.items():
            if name not in ServoInput.field_names():
                raise TypeError(f"set_input() has no option {name!r}; it has {', '.join(ServoInput.field_names())}")
            setattr(self._input, name, _abi.convert(kinds[name], value))
        self._check(self._lib.frm_servo_set_input(self.handle, byref(self._input)))

    def engage(self) -> None:
        """Forces from its next tick on, beginning at zero."""
        self._check(self._lib.frm_servo_engage(self.handle))

    def disengage(self) -> None:
        """No forces from its next tick on."""
        self._check(self._lib.frm_servo_disengage(self.handle))

    def clear_fault(self) -> None:
        """Forgets the fault that is latched."""
        self._check(self._lib.frm_servo_clear_fault(self.handle))

    def state(self) -> ServoState:
        """The newest state; any thread may ask."""
        return self._filled(ServoState, self._lib.frm_servo_get_state)

    def stats(self) -> ServoStats:
        """How punctual it is; any thread may ask."""
        return self._filled(ServoStats, self._lib.frm_servo_get_stats)

    def histogram(self, which: ServoTime = ServoTime.SERVO_TICK) -> list[tuple[int, int]]:
        """(lower edge in ns, ticks) of each bin; any thread may ask."""
        count = c_uint32()
        function = self._lib.frm_servo_get_histogram
        self._check(function(self.handle, which, None, None, 0, byref(count)))
        edges, counts = (c_uint64 * count.value)(), (c_uint64 * count.value)()
        self._check(function(self.handle, which, edges, counts, count.value, byref(count)))
        return list(zip(edges, counts))
