"""What every class of the binding stands on: handles, errors, defs, texts; and the context itself.

A method is the function's name without the object and without ``get_``: frm_body_get_forces is `Body.forces`.
What the library owns is closed by `close`, by leaving a ``with`` block, or with the object that it was made
in; letting go of the Python object closes nothing, but for a Context that nobody holds any more.
"""
from __future__ import annotations

import ctypes
import os
import weakref
from ctypes import byref, c_uint32, c_uint64, sizeof
from typing import Optional

from . import _abi
from ._abi import ContextDef, LogLevel, Status
from ._library import library


class Error(Exception):
    """A function of the library failed: `status` says how, `text` what was wrong with which argument."""

    def __init__(self, status: int, text: str = ""):
        try:
            self.status = Status(status)
        except ValueError:
            self.status = status
        self.text = text
        name = library().frm_status_name(status).decode()
        super().__init__(f"{name}: {text}" if text else name)


def version() -> tuple[int, int, int]:
    """The version of the library that runs."""
    parts = [c_uint32() for _ in range(3)]
    library().frm_version(*map(byref, parts))
    return tuple(part.value for part in parts)


def definition_of(kind, initialise, who: str, options: dict):
    """A def with the library's defaults and the caller's options."""
    definition = kind()
    initialise(byref(definition), sizeof(definition))
    kinds = {name: field for name, field in kind._fields_ if name in kind.field_names()}
    for name, value in options.items():
        if name not in kinds:
            raise TypeError(f"{who}() has no option {name!r}; it has {', '.join(kinds)}")
        if isinstance(kinds[name], type(ctypes.CFUNCTYPE(None))) and not isinstance(value, kinds[name]):
            value = kinds[name](value)
        try:
            setattr(definition, name, _abi.convert(kinds[name], value))
        except (TypeError, ValueError) as error:
            raise TypeError(f"{who}({name}={value!r}): {error}") from None
        # ctypes cuts an integer that does not fit without a word.
        if kinds[name] in (c_uint32, c_uint64) and getattr(definition, name) != value:
            raise OverflowError(f"{who}({name}={value!r}) does not fit")
    return definition


def utf8(path) -> bytes:
    path = os.fspath(path)
    return path if isinstance(path, bytes) else path.encode("utf-8")


class Object:
    """A handle: `handle` is the number that C code takes, 0 once closed."""

    _close_function = ""

    def __init__(self, context: "Context", handle: int, owned: bool = True):
        self.context = context
        self.handle = handle
        self._owned = owned
        self._lib = library()

    @property
    def closed(self) -> bool:
        return self.handle == 0

    def close(self) -> None:
        """Closes the object and all that was made in it. Calling it again does nothing."""
        if self.handle and self._owned:
            status = getattr(self._lib, self._close_function)(self.handle)
            # A handle that went stale with the object it was made in is as closed as can be.
            if status != Status.ERROR_HANDLE:
                self._check(status)
        self.handle = 0

    def __enter__(self):
        return self

    def __exit__(self, *exception) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<frm.{type(self).__name__} {f'{self.handle:#x}' if self.handle else 'closed'}>"

    def _check(self, status: int) -> None:
        if status:
            raise self._error(status)

    def _error(self, status: int) -> Error:
        if not self.handle:
            return Error(status, f"the {type(self).__name__} is closed")
        return Error(status, self.context.last_error())

    def _filled(self, kind, function):
        """A struct that `function` fills."""
        struct = kind.sized()
        self._check(function(self.handle, byref(struct)))
        return struct

    def _made(self, function, *arguments) -> int:
        """The handle that `function` writes."""
        handle = c_uint64()
        self._check(function(*arguments, byref(handle)))
        return handle.value


def two_calls(call) -> tuple[int, bytes]:
    """(status, text) by the two-call rule; call(text, capacity, size) is the library's function."""
    size = c_uint64()
    status = call(None, 0, byref(size))
    if status or not size.value:
        return status, b""
    text = ctypes.create_string_buffer(size.value)
    return call(text, size.value, byref(size)), text.value


class Context(Object):
    """The root of all other objects.

    Options: axes, threads, log_capacity, allocate, release, allocator_user.
    """

    def __init__(self, **options):
        lib = library()
        definition = definition_of(ContextDef, lib.frm_context_def_init, "Context", options)
        handle = c_uint64()
        if status := lib.frm_context_create(byref(definition), byref(handle)):
            raise Error(status)
        super().__init__(self, handle.value)
        self.axes = definition.axes
        # What C calls back must outlive the context, also when the interpreter ends with it open.
        self._callbacks = {0: definition}
        self._finalizer = weakref.finalize(self, _destroy_context, lib, handle.value, self._callbacks)
        self.context = weakref.proxy(self)

    def close(self) -> None:
        """Destroys the context and everything made in it; recordings still open are closed first."""
        status = self._finalizer()
        self.handle = 0
        if status and status != Status.ERROR_HANDLE:
            raise Error(status)

    def last_error(self) -> str:
        """What was wrong with which argument in the last call that failed."""
        _, text = two_calls(lambda *a: self._lib.frm_context_last_error(self.handle, *a))
        return text.decode("utf-8", "replace")

    def poll_log(self) -> Optional[tuple[LogLevel, str]]:
        """Takes the oldest waiting log message; None when there is none."""
        level = c_uint32()
        status, text = two_calls(lambda *a: self._lib.frm_context_poll_log(self.handle, byref(level), *a))
        self._check(status)
        return (LogLevel(level.value), text.decode("utf-8", "replace")) if text else None


def _destroy_context(lib, handle: int, callbacks: dict) -> int:
    status = lib.frm_context_destroy(handle)
    callbacks.clear()
    return status


def wrap(cls, context, handle: int, owned: bool = True):
    """An object around a handle that exists already."""
    made = cls.__new__(cls)
    Object.__init__(made, context, handle, owned)
    return made
