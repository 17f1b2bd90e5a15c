"""Devices, opened by a driver in C or in Python."""
from __future__ import annotations

from ctypes import byref, c_uint8, c_uint32, sizeof

from . import _abi
from ._abi import DeviceCommand, DeviceDriver, DeviceInfo, DeviceSafetyState, DeviceState, Wrench
from ._base import Context, Error, Object, definition_of, utf8, wrap
from ._driver import Driver


class Device(Object):
    """A haptic device, opened by a driver: a `Driver`, or a DeviceDriver table with its `user` pointer."""

    _close_function = "frm_device_close"

    def __init__(self, context: Context, driver, index: int = 0, user=None):
        with _exceptions_of(driver):
            handle = context._made(context._lib.frm_device_open, context.handle, byref(_table(driver)),
                                   user, index)
        super().__init__(context, handle)
        self._driver = context._callbacks[handle] = driver

    @classmethod
    def enumerate(cls, context: Context, driver, user=None) -> list[DeviceInfo]:
        """The devices that a driver sees."""
        count = c_uint32()
        table = byref(_table(driver))
        function = context._lib.frm_device_enumerate
        with _exceptions_of(driver):
            context._check(function(context.handle, table, user, None, 0, byref(count)))
            infos = (DeviceInfo * count.value)()
            for info in infos:
                info.struct_size = sizeof(DeviceInfo)
            context._check(function(context.handle, table, user, infos, len(infos), byref(count)))
        return list(infos[:count.value])

    @classmethod
    def open_null(cls, context: Context) -> "Device":
        """A device that is not there: it rests, and swallows forces."""
        return wrap(cls, context, context._made(context._lib.frm_device_open_null, context.handle))

    @classmethod
    def open_replay(cls, context: Context, path, index: int = 0) -> "Device":
        """A device that moves as device `index` of a recording did."""
        handle = context._made(context._lib.frm_device_open_replay, context.handle, utf8(path), index)
        return wrap(cls, context, handle)

    @classmethod
    def enumerate_spidar_g(cls, context: Context, configuration=None) -> list[DeviceInfo]:
        """The SPIDAR-G that answer; serial is the rotary switch."""
        count = c_uint32()
        function = context._lib.frm_device_enumerate_spidar_g
        path = None if configuration is None else utf8(configuration)
        # The switch has sixteen positions, and every device is asked anew in each call.
        infos = (DeviceInfo * 16)()
        for info in infos:
            info.struct_size = sizeof(DeviceInfo)
        context._check(function(context.handle, path, infos, len(infos), byref(count)))
        return list(infos[:min(count.value, len(infos))])

    @classmethod
    def open_spidar_g(cls, context: Context, configuration=None, rotary: int = -1) -> "Device":
        """A SPIDAR-G over USB or HID, as its configuration says (None: the built-in one). rotary -1: any."""
        path = None if configuration is None else utf8(configuration)
        handle = context._made(context._lib.frm_device_open_spidar_g, context.handle, path, rotary)
        return wrap(cls, context, handle)

    @classmethod
    def open_simulated(cls, context: Context, configuration=None) -> "Device":
        """A simulated SPIDAR-G with a hand that holds it."""
        path = None if configuration is None else utf8(configuration)
        return wrap(cls, context, context._made(context._lib.frm_device_open_simulated, context.handle, path))

    def close(self) -> None:
        """Stops the device and closes it. Calling it again does nothing."""
        handle = self.handle
        with _exceptions_of(self._driver):
            super().close()
        self.context._callbacks.pop(handle, None)

    def info(self) -> DeviceInfo:
        """What the device is: name (bytes, UTF-8), max_force (N), max_torque (N m), period_ns."""
        with _exceptions_of(self._driver):
            return self._filled(DeviceInfo, self._lib.frm_device_get_info)

    def calibrate(self) -> None:
        """Tells the device that its grip is at the reference pose."""
        with _exceptions_of(self._driver):
            self._check(self._lib.frm_device_calibrate(self.handle))

    def exchange(self, wrench=None, deadline_ns: int = 0) -> DeviceState:
        """One cycle: displays a wrench (N, N m; None for no force) and gives the grip's state.

        The device goes to its safe state if no exchange follows within deadline_ns; 0: its default.
        """
        command = None
        if wrench is not None or deadline_ns:
            command = DeviceCommand.sized()
            command.deadline_ns = deadline_ns
            if wrench is not None:
                command.wrench = _abi.convert(Wrench, wrench)
            command = byref(command)
        state = DeviceState.sized()
        with _exceptions_of(self._driver):
            self._check(self._lib.frm_device_exchange(self.handle, command, byref(state)))
        return state

    def raw(self) -> bytes:
        """The packet that the last exchange read; empty where the driver gives none."""
        packet, size = (c_uint8 * 512)(), c_uint32()
        with _exceptions_of(self._driver):
            self._check(self._lib.frm_device_get_raw(self.handle, packet, len(packet), byref(size)))
        return bytes(packet[:size.value])

    def stop(self) -> None:
        """Safe state at once."""
        with _exceptions_of(self._driver):
            self._check(self._lib.frm_device_stop(self.handle))

    def set_safety(self, **options) -> None:
        """Sets the limits of the safety layer: the fields of DeviceSafetyDef, the rest at their defaults."""
        definition = definition_of(_abi.DeviceSafetyDef, self._lib.frm_device_safety_def_init, "set_safety", options)
        self._check(self._lib.frm_device_set_safety(self.handle, byref(definition)))

    def safety(self) -> DeviceSafetyState:
        """What the safety layer is doing; `reason` (bytes, UTF-8) says which fault is latched."""
        return self._filled(DeviceSafetyState, self._lib.frm_device_get_safety)

    def engage(self) -> None:
        """Forces from now on, beginning at zero."""
        with _exceptions_of(self._driver):
            self._check(self._lib.frm_device_engage(self.handle))

    def disengage(self) -> None:
        """No forces from now on."""
        self._check(self._lib.frm_device_disengage(self.handle))

    def clear_fault(self) -> None:
        """Forgets the fault that is latched; the device stays disengaged."""
        self._check(self._lib.frm_device_clear_fault(self.handle))

    _driver = None


def _table(driver) -> DeviceDriver:
    return driver.table if isinstance(driver, Driver) else driver


class _exceptions_of:
    """Gives an Error its cause: the exception that a Python driver raised within the call."""

    def __init__(self, driver):
        self.driver = driver if isinstance(driver, Driver) else None

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace) -> None:
        exception = self.driver.take_exception() if self.driver else None
        if exception is None:
            return
        # Ctrl-C within a driver stops the program, as it does elsewhere.
        if not isinstance(exception, Exception):
            raise exception
        if isinstance(error, Error):
            error.__cause__ = exception
