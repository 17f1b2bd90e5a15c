"""The header's own rules: every function is documented and carries one thread tag, structs may grow, plain types only.

usage: check_header.py include/frm.h"""

import re
import sys

import header

TAG = re.compile(r"\[(any|owner|realtime|offline)\]")
PLAIN = {"char", "int32_t", "uint8_t", "uint32_t", "int64_t", "uint64_t", "float", "double", "*"}
HANDLES = {"frm_" + name for name in "context map world water body device recorder replay servo bake".split()}
# Values that will not grow; all other structs begin with struct_size. The sources' states go in arrays of many.
FIXED = {"frm_vec3", "frm_position", "frm_quaternion", "frm_pose", "frm_twist", "frm_wrench", "frm_source_state"}


def check_function(function, report):
    name = function.name
    tags = TAG.findall(function.comment)
    words = TAG.sub("", function.comment).split()
    if not function.comment:
        report.complain(f"{name} has no comment directly before it")
        return
    if len(tags) != 1:
        report.complain(f"{name} carries {len(tags)} thread tags, not one: {tags}")
    if not words:
        report.complain(f"{name}: the comment says nothing")
    if function.returns != "frm_status" and name != "frm_status_name":
        report.complain(f"{name} returns {function.returns}, not frm_status")
    for parameter in function.parameters:
        kind = re.sub(r"^const ", "", parameter).split(" ")[0]
        if kind not in PLAIN | HANDLES | {"frm_status", "void"} and "*" not in parameter:
            report.complain(f"{name}: {parameter} does not go by pointer")


def check_struct(struct, structs, report):
    if struct.name not in FIXED and struct.fields[0] != ("struct_size", "uint32_t"):
        report.complain(f"{struct.name} does not begin with uint32_t struct_size")
    for name, kind in struct.fields:
        base = kind.split("[")[0]
        if base not in PLAIN | HANDLES and base not in structs:
            report.complain(f"{struct.name}.{name} is of type {kind}: not a fixed-width type")


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        text = file.read()
    parsed = header.parse(text)
    report = header.Report()
    for function in parsed.functions.values():
        check_function(function, report)
    for struct in parsed.structs.values():
        check_struct(struct, parsed.structs, report)
    for name in FIXED - set(parsed.structs) if parsed.version else ():
        report.complain(f"{name} is not in the header any more")
    for name in [n for n in parsed.structs if n.endswith("_def")]:
        if f"{name}_init" not in parsed.functions:
            report.complain(f"{name} has no {name}_init")
    for number, line in enumerate(text.split("\n"), 1):
        if len(line) > 120 or not line.isascii() or line != line.rstrip():
            report.complain(f"line {number}: over 120 columns, not ASCII, or with trailing space")
    counts = f"{len(parsed.functions)} functions, {len(parsed.structs)} structs, {len(parsed.constants)} constants"
    return report.finish(counts)


if __name__ == "__main__":
    sys.exit(main())
