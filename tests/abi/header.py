"""Reads include/frm.h: its functions with their comments, its structs with their fields, its constants.

Not a C parser: it knows the few forms that the header uses, and stops with an error at any other, so that nothing in
the header can escape the checks built on it."""

import re
from dataclasses import dataclass, field


@dataclass
class Function:
    name: str
    returns: str
    parameters: list
    comment: str  # empty if there is none directly before it


@dataclass
class Struct:
    name: str
    fields: list = field(default_factory=list)  # (name, type); a type is "float", "char[64]", "*" for any pointer


@dataclass
class Header:
    functions: dict
    structs: dict
    constants: dict  # enumerators: name -> value
    version: tuple  # None in a header that builds on frm.h


class HeaderError(Exception):
    pass


def _strip(text):
    """Without comments and preprocessor lines, one space between words."""
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
    text = re.sub(r"^\s*#.*?(?<!\\)$", " ", text, flags=re.M)
    return re.sub(r"\s+", " ", text).strip()


def _fields(body):
    result = []
    for statement in filter(None, (s.strip() for s in body.split(";"))):
        pointer = re.fullmatch(r"frm_status ?\(FRM_CALL \*(\w+)\) ?\(.*\)", statement)
        if pointer:
            result.append((pointer[1], "*"))
            continue
        match = re.fullmatch(r"(?:const )?(\w+) (.+)", statement)
        if not match:
            raise HeaderError(f"a struct field that header.py cannot read: {statement}")
        for declarator in match[2].split(","):
            declared = re.fullmatch(r"(\*?) ?(\w+)(\[\d+\])?", declarator.strip())
            if not declared:
                raise HeaderError(f"a struct field that header.py cannot read: {statement}")
            kind = "*" if declared[1] or match[1].endswith("_fn") else match[1] + (declared[3] or "")
            result.append((declared[2], kind))
    return result


def _constants(body):
    result, following = {}, 0
    for item in filter(None, (s.strip() for s in body.split(","))):
        match = re.fullmatch(r"(\w+)(?: ?= ?(-?\w+))?", item)
        if not match:
            raise HeaderError(f"an enumerator that header.py cannot read: {item}")
        value = int(match[2], 0) if match[2] else following
        result[match[1]] = value
        following = value + 1
    return result


def read(path):
    with open(path, encoding="utf-8") as file:
        text = file.read()
    return parse(text)


def parse(text):
    functions = {}
    for match in re.finditer(r"^FRM_API\b(.*?);", text, flags=re.M | re.S):
        declared = re.fullmatch(r"\s*(.+?)\s*FRM_CALL\s+(frm_\w+)\((.*)\)", match[1], flags=re.S)
        if not declared:
            raise HeaderError(f"a function that header.py cannot read: {match[0]}")
        before = re.search(r"/\*((?:(?!\*/).)*)\*/[ \t]*\n\Z", text[: match.start()], flags=re.S)
        name = declared[2]
        if name in functions:
            raise HeaderError(f"{name} is declared twice")
        parameters = [] if declared[3].strip() == "void" else re.sub(r"\s+", " ", declared[3]).split(", ")
        functions[name] = Function(name, declared[1].strip(), parameters, before[1].strip() if before else "")

    code = _strip(text)
    declared = len(re.findall(r"\bFRM_CALL frm_\w+ ?\(", code))
    if declared != len(functions):
        raise HeaderError(f"{declared} functions are declared but {len(functions)} begin a line with FRM_API")

    structs = {}
    for match in re.finditer(r"\bstruct (\w+) \{(.*?)\} (\w+);", code):
        if match[1] != match[3]:
            raise HeaderError(f"struct {match[1]} has another name as a type: {match[3]}")
        structs[match[1]] = Struct(match[1], _fields(match[2]))
    if len(structs) != len(re.findall(r"\b(?:struct|union)\b", code)):
        raise HeaderError("a struct or union in a form that header.py cannot read")

    constants = {}
    enums = re.findall(r"\benum(?: \w+)? \{(.*?)\}", code)
    if len(enums) != len(re.findall(r"\benum\b", code)):
        raise HeaderError("an enum in a form that header.py cannot read")
    for body in enums:
        constants.update(_constants(body))

    version = []
    for part in ("MAJOR", "MINOR", "PATCH"):
        match = re.search(rf"^#define FRM_VERSION_{part} (\d+)$", text, flags=re.M)
        if match:
            version.append(int(match[1]))
    if len(version) != (0 if '#include "frm.h"' in text else 3):
        raise HeaderError("FRM_VERSION_MAJOR, _MINOR or _PATCH is missing")
    return Header(functions, structs, constants, tuple(version) or None)


class Report:
    """Collects complaints; exit status 1 if there are any."""

    def __init__(self):
        self.complaints = 0

    def complain(self, text):
        self.complaints += 1
        print(f"wrong: {text}")

    def finish(self, checked):
        print(f"{checked}: {self.complaints} complaints" if self.complaints else f"{checked}: all well")
        return 1 if self.complaints else 0
