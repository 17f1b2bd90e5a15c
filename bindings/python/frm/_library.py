"""Finds and loads the shared library, once, with the types of every function set."""
from __future__ import annotations

import ctypes
import ctypes.util
import functools
import os
import sys
from pathlib import Path

from . import _abi

_FILE_NAMES = {"win32": ("frm.dll", "libfrm.dll"),
               "darwin": ("libfrm.dylib", f"libfrm.{_abi.VERSION_MAJOR}.dylib")}


class LibraryError(ImportError):
    """The shared library is missing, or is of a version that this binding does not know."""


def candidates() -> list[str]:
    """Where the library may be, best first. FRM_LIBRARY, when set, is the only place."""
    if named := os.environ.get("FRM_LIBRARY"):
        return [os.path.abspath(named)]
    package = Path(__file__).resolve().parent
    names = _FILE_NAMES.get(sys.platform, ("libfrm.so", f"libfrm.so.{_abi.VERSION_MAJOR}"))
    found = [package / name for name in names if (package / name).is_file()]
    if len(package.parents) > 2 and (package.parents[2] / "include" / "frm.h").is_file():
        built = [path for name in names for path in package.parents[2].glob(f"build/*/{name}")]
        found += sorted(built, key=lambda path: path.stat().st_mtime, reverse=True)
    # Installed as PREFIX/share/frm/python/frm, beside PREFIX/lib.
    if len(package.parents) > 3 and package.parent.parts[-3:] == ("share", "frm", "python"):
        found += [path for name in names for path in sorted(package.parents[3].glob(f"lib*/**/{name}"))]
    installed = ctypes.util.find_library("frm")
    return [str(path) for path in found] + ([installed] if installed else [])


def load(path: str) -> ctypes.CDLL:
    """The library at `path`, checked and typed."""
    try:
        library = ctypes.CDLL(path)
    except OSError as error:
        raise LibraryError(f"the frm library cannot be loaded: {error}") from error
    _check_version(library, path)
    for name, (restype, argtypes) in _abi.FUNCTIONS.items():
        try:
            function = getattr(library, name)
        except AttributeError:
            raise LibraryError(f"{path} lacks {name}") from None
        function.restype = restype
        function.argtypes = argtypes
    return library


def _check_version(library: ctypes.CDLL, path: str) -> None:
    try:
        function = library.frm_version
    except AttributeError:
        raise LibraryError(f"{path} is not the frm library") from None
    function.restype, function.argtypes = _abi.FUNCTIONS["frm_version"]
    parts = [ctypes.c_uint32() for _ in range(3)]
    function(*parts)
    major, minor, patch = (part.value for part in parts)
    # Before 1.0 a minor version may change anything; from then on a newer library serves an older binding.
    ours = (_abi.VERSION_MAJOR, _abi.VERSION_MINOR)
    fits = major == ours[0] and (minor == ours[1] if major == 0 else minor >= ours[1])
    if not fits:
        raise LibraryError(f"{path} is frm {major}.{minor}.{patch}; this binding is for {ours[0]}.{ours[1]}")


@functools.lru_cache(maxsize=None)
def library() -> ctypes.CDLL:
    """The library, loaded at the first call; every function of the header is there, typed."""
    places = candidates()
    if not places:
        raise LibraryError("the frm library was not found: set FRM_LIBRARY to the path of libfrm")
    return load(places[0])
