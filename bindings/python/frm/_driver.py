"""Devices written in Python: a class behind the C driver table."""
from __future__ import annotations

import ctypes
from ctypes import byref, sizeof

from . import _abi
from ._abi import DeviceCommand, DeviceDriver, DeviceInfo, DeviceState, Status


class Driver:
    """Base class of a device driver in Python; override what the device has.

    An exception in a method becomes FRM_ERROR_DEVICE for the library, and the cause (``__cause__``) of the
    frm.Error that the caller of the Device then sees. Python is not for the servo loop: a 1 kHz device needs
    a driver in C.
    """

    def enumerate(self) -> list[DeviceInfo]:
        """The devices that are there."""
        raise NotImplementedError

    def open(self, index: int):
        """Opens device `index`; returns any object, which the other methods get as `instance`."""
        raise NotImplementedError

    def close(self, instance) -> None:
        """Closes the device."""

    def info(self, instance) -> DeviceInfo:
        """What the device is: name (bytes, UTF-8), serial, max_force (N), max_torque (N m), period_ns."""
        raise NotImplementedError

    def calibrate(self, instance) -> None:
        """The grip is at its reference pose now."""

    def exchange(self, instance, command: DeviceCommand, state: DeviceState) -> None:
        """One cycle: takes the command, fills the state in place. Both are valid only during the call."""
        raise NotImplementedError

    def stop(self, instance) -> None:
        """Safe state at once: no force."""

    def raw(self, instance) -> bytes:
        """The packet of the last exchange, at most 512 bytes; empty where there is none."""
        return b""

    # The rest is the table that the library calls. Instances are numbered, because C keeps only a pointer.

    @property
    def table(self) -> DeviceDriver:
        """The C driver table of this object. It lives as long as the object does."""
        if "_table" not in self.__dict__:
            self._instances = {}
            self._opened = 0
            self._exception = None
            table = DeviceDriver.sized()
            for name, kind in DeviceDriver._fields_[2:]:
                setattr(table, name, kind(self._guarded(getattr(self, f"_c_{name}"))))
            self._table = table
        return self._table

    def take_exception(self) -> BaseException | None:
        """The exception of the last call that failed, once."""
        exception, self._exception = self._exception, None
        return exception

    def _guarded(self, function):
        def call(user, *arguments):
            # An exception that leaves a ctypes callback is only printed, and the library would see success.
            try:
                function(*arguments)
            except BaseException as exception:
                self._exception = exception
                return Status.ERROR_DEVICE.value
            return Status.OK.value
        return call

    def _c_enumerate(self, into, capacity, count):
        devices = self.enumerate()
        count[0] = len(devices)
        for index, info in enumerate(devices[:capacity] if into else []):
            _fill(into[index], info)

    def _c_open(self, index, instance):
        opened = self.open(index)
        self._opened += 1
        self._instances[self._opened] = opened
        instance[0] = self._opened

    def _c_close(self, instance):
        self.close(self._instances.pop(instance))

    def _c_info(self, instance, into):
        _fill(into[0], self.info(self._instances[instance]))

    def _c_calibrate(self, instance):
        self.calibrate(self._instances[instance])

    def _c_exchange(self, instance, command, state):
        self.exchange(self._instances[instance], command[0], state[0])

    def _c_stop(self, instance):
        self.stop(self._instances[instance])

    def _c_raw(self, instance, data, capacity, size):
        packet = bytes(self.raw(self._instances[instance]))[:capacity]
        ctypes.memmove(data, packet, len(packet))
        size[0] = len(packet)


def _fill(target: DeviceInfo, info: DeviceInfo) -> None:
    """Copies what the receiver has room for, and keeps the size that it gave."""
    size = target.struct_size or sizeof(DeviceInfo)
    ctypes.memmove(byref(target), byref(_abi.convert(DeviceInfo, info)), min(size, sizeof(DeviceInfo)))
    target.struct_size = size
