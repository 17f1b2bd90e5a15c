"""Arrays of float32: into the library without a copy where possible, out of it as numpy's or plain."""
from __future__ import annotations

import ctypes
from array import array

from . import _abi

try:
    import numpy
except ImportError:
    numpy = None


def floats_in(values):
    """(pointer or ctypes array, count) of the numbers in `values`.

    A contiguous float32 buffer (numpy array of any shape, array('f'), memoryview) is used where it lies;
    anything else is copied. The first result keeps the memory alive.
    """
    try:
        view = memoryview(values)
    except TypeError:
        view = None
    if view is not None and view.format == "f" and view.c_contiguous:
        if not view.readonly:
            return writable(view), view.nbytes // 4
        if numpy is None:
            copy = array("f")
            copy.frombytes(view.cast("B"))
            return writable(copy), len(copy)
    if numpy is not None:
        flat = numpy.ascontiguousarray(values, dtype=numpy.float32).reshape(-1)
        return flat.ctypes.data_as(ctypes.POINTER(ctypes.c_float)), flat.size
    copy = array("f", values)
    return writable(copy), len(copy)


def writable(buffer):
    """A ctypes array over a writable, contiguous float32 buffer."""
    view = memoryview(buffer)
    if view.format != "f" or not view.c_contiguous or view.readonly:
        raise TypeError("the buffer must be writable, contiguous and of float32")
    return (ctypes.c_float * (view.nbytes // 4)).from_buffer(view)


def new_floats(rows: int, columns: int):
    """numpy: an array of shape (rows, columns); else a flat array('f'), row after row."""
    if numpy is not None:
        return numpy.zeros((rows, columns), dtype=numpy.float32)
    return array("f", bytes(4 * rows * columns))


def structs_out(values):
    """A ctypes array of structs as a structured numpy array on the same memory; without numpy, as it is."""
    return values if numpy is None else numpy.frombuffer(values, dtype=_dtype(values._type_))


def _dtype(kind):
    """The numpy type of a struct; a vector in it becomes one field of shape (n,)."""
    names, formats, offsets = [], [], []
    for name, field in kind._fields_:
        names.append(name)
        offsets.append(getattr(kind, name).offset)
        if issubclass(field, _abi.Vector):
            formats.append((numpy.dtype(field._fields_[0][1]), (len(field._fields_),)))
        else:
            formats.append(numpy.dtype(field))
    return numpy.dtype({"names": names, "formats": formats, "offsets": offsets,
                        "itemsize": ctypes.sizeof(kind)})
