"""The binding says what include/frm.h says: nothing less, nothing more, nothing else."""
from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from ctypes import POINTER

import pytest
from conftest import ROOT

import frm
from frm import _abi

NUMBERS = {"uint8_t": ctypes.c_uint8, "uint32_t": ctypes.c_uint32, "uint64_t": ctypes.c_uint64, "int32_t": ctypes.c_int32,
           "float": ctypes.c_float, "double": ctypes.c_double}
# `const char *` is text that goes in; `char *` is a buffer that the library fills.
TEXTS = {"const char *": ctypes.c_char_p, "char *": POINTER(ctypes.c_char), "void *": ctypes.c_void_p,
         "const void *": ctypes.c_void_p, "void **": POINTER(ctypes.c_void_p)}


def camel(name: str) -> str:
    """frm_map_info -> MapInfo."""
    return "".join(part.capitalize() for part in name.removeprefix("frm_").split("_"))


class Header:
    """What regular expressions find in the header; `rest` is what none of them took."""

    def __init__(self, text: str):
        self.types = dict(NUMBERS)
        self.macros, self.enums, self.structs, self.functions = {}, {}, {}, {}
        text = re.sub(r"/\*.*?\*/|//[^\n]*", " ", text, flags=re.S)
        text = re.sub(r"#ifdef __cplusplus.*?#endif", "", text, flags=re.S)
        for name, value in re.findall(r"^#define (FRM_\w+) +(-?\d+)\s*$", text, flags=re.M):
            self.macros[name] = int(value)
        text = re.sub(r"^#.*$", "", text, flags=re.M)
        self.rest = text
        self._take(r"typedef (\w+) (frm_\w+);", self._alias)
        self._take(r"(?:typedef )?enum (frm_\w+)? ?\{([^}]*)\} ?(?:frm_\w+)? ?;", self._enum)
        # In the order of the file, because later declarations use earlier ones.
        self._take(r"typedef struct (frm_\w+) \{(.*?)\} \1;"
                   r"|typedef ([\w ]+\*? ?)\( ?FRM_CALL \*(frm_\w+)\)\(([^)]*)\);", self._struct_or_callback)
        self._take(r"FRM_API ([\w ]+?\*?) ?FRM_CALL (frm_\w+)\(([^)]*)\);", self._function)

    def _take(self, pattern: str, use) -> None:
        self.rest = re.sub(r"\s+", " ", self.rest)
        self.rest = re.sub(pattern, lambda match: use(*match.groups()) or "", self.rest)

    def _alias(self, kind, name):
        self.types[name] = self.types[kind]

    def _enum(self, name, body):
        values = dict(re.findall(r"(FRM_\w+) ?= ?(-?\d+)", body))
        assert len(values) == len([item for item in body.split(",") if item.strip()])
        self.enums[name or "frm_status"] = {key: int(value) for key, value in values.items()}

    def _struct_or_callback(self, struct, body, result, callback, arguments):
        if callback:
            self.types[callback] = self._callback(result, arguments)
            return
        fields = []
        for declaration in filter(None, map(str.strip, body.split(";"))):
            if match := re.fullmatch(r"([\w ]+?\*?) ?\( ?FRM_CALL \*(\w+)\)\((.*)\)", declaration):
                fields.append((match[2], self._callback(match[1], match[3])))
            elif match := re.fullmatch(r"(char|double) (\w+)\[(\d+)\]", declaration):
                fields.append((match[2], getattr(ctypes, f"c_{match[1]}") * int(match[3])))
            else:
                kind, names = re.fullmatch(r"((?:const )?\w+ \**)(.*)", declaration).groups()
                fields += [(name.strip(), self.type(kind)) for name in names.split(",")]
        self.structs[struct] = fields
        # The binding's own class stands for the struct, so that pointers to it compare equal.
        self.types[struct] = getattr(_abi, camel(struct))

    def _function(self, result, name, arguments):
        self.functions[name] = (self.type(result), self._arguments(arguments))

    def _callback(self, result, arguments):
        return ctypes.CFUNCTYPE(self.type(result), *self._arguments(arguments))

    def _arguments(self, text):
        return tuple(self.type(re.fullmatch(r"(.*?)\w+", item.strip())[1]) for item in text.split(","))

    def type(self, text: str):
        text = re.sub(r" ?(\*+)", r" \1", text).strip()
        if text == "void":
            return None
        if text in TEXTS:
            return TEXTS[text]
        name, _, stars = text.removeprefix("const ").partition(" ")
        assert stars in ("", "*"), text
        return POINTER(self.types[name]) if stars else self.types[name]


@pytest.fixture(scope="module")
def header() -> Header:
    return Header((ROOT / "include" / "frm.h").read_text())


def test_the_parser_takes_the_whole_header(header):
    assert header.rest.strip() == ""
    assert len(header.functions) > 50 and len(header.structs) > 20 and len(header.enums) >= 8


def test_macros(header):
    ours = {f"FRM_{name}": getattr(_abi, name) for name in vars(_abi) if name.startswith("VERSION_")}
    assert ours == header.macros


def test_enums(header):
    ours = {kind.__name__: {f"FRM_{m.name}": m.value for m in kind} for kind in _abi.ENUMS}
    assert ours == {camel(name): values for name, values in header.enums.items()}


def test_enum_values_are_in_the_package(header):
    for values in header.enums.values():
        for name, value in values.items():
            assert getattr(frm, name.removeprefix("FRM_")) == value


def test_structs(header):
    ours = {kind.__name__: list(kind._fields_) for kind in _abi.STRUCTS}
    theirs = {camel(name): fields for name, fields in header.structs.items()}
    assert list(ours) == list(theirs)
    for name, fields in theirs.items():
        assert ours[name] == fields, name


def test_struct_table_is_complete():
    everything = {kind for kind in vars(_abi).values() if isinstance(kind, type)
                  and issubclass(kind, _abi.Struct) and kind not in (_abi.Struct, _abi.Vector)}
    assert everything == set(_abi.STRUCTS)


def test_handles_and_callbacks(header):
    for name, kind in header.types.items():
        if name.endswith("_fn"):
            assert getattr(_abi, camel(name)) is kind
        elif name.startswith("frm_") and name not in header.structs:
            assert getattr(_abi, name) is kind


def test_functions(header):
    assert list(_abi.FUNCTIONS) == list(header.functions)
    for name, signature in header.functions.items():
        assert _abi.FUNCTIONS[name] == signature, name


def test_loaded_library_is_typed(library, header):
    for name, (result, arguments) in header.functions.items():
        function = getattr(library, name)
        assert function.restype is result and tuple(function.argtypes) == arguments


def test_every_function_is_used_by_a_class():
    sources = "".join(path.read_text() for path in (ROOT / "bindings/python/frm").glob("_*.py")
                      if path.name != "_abi.py")
    assert [name for name in _abi.FUNCTIONS if not re.search(rf"\b{name}\b", sources)] == []


def test_layout_is_what_the_c_compiler_makes(header, tmp_path):
    compiler = shutil.which("cc")
    if not compiler:
        pytest.skip("no C compiler: cc")
    lines, expected = [], []
    for name, fields in header.structs.items():
        kind = getattr(_abi, camel(name))
        lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
        expected.append(f"{name} {ctypes.sizeof(kind)}")
        for field, _ in fields:
            lines.append(f'printf("{name}.{field} %zu %zu\\n", offsetof({name}, {field}), '
                         f"sizeof((({name} *)0)->{field}));")
            ours = getattr(kind, field)
            expected.append(f"{name}.{field} {ours.offset} {ours.size}")
    constants = {**header.macros, **{k: v for values in header.enums.values() for k, v in values.items()}}
    for name, value in constants.items():
        lines.append(f'printf("{name} %d\\n", (int){name});')
        expected.append(f"{name} {value}")
    source = tmp_path / "layout.c"
    source.write_text("#include <frm.h>\n#include <stddef.h>\n#include <stdio.h>\nint main(void) {\n"
                      + "\n".join(lines) + "\nreturn 0; }\n")
    program = tmp_path / "layout"
    subprocess.run([compiler, "-std=c99", "-Wall", "-Werror", "-I", ROOT / "include", source, "-o", program],
                   check=True)
    printed = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    assert printed.splitlines() == expected
