"""Whether the tables of the ABI tests are complete: layout.c lists every struct and field of the header in order,
values.c every constant, and the programs in calls/ call every function.

usage: check_tables.py include/frm.h DIRECTORY_OF_THIS_TEST"""

import pathlib
import re
import sys

import header


def without_comments(path):
    text = path.read_text(encoding="utf-8")
    return re.sub(r"/\*.*?\*/|\"(?:\\.|[^\"\\])*\"", " ", text, flags=re.S)


def compare(what, in_header, in_table, report):
    for name in in_header:
        if name not in in_table:
            report.complain(f"{what} is missing: {name}")
    for name in in_table:
        if name not in in_header:
            report.complain(f"{what} names what the header does not have: {name}")
    if len(in_table) != len(set(in_table)):
        report.complain(f"{what} names something twice")


def main():
    parsed = header.read(sys.argv[1])
    here = pathlib.Path(sys.argv[2])
    report = header.Report()

    layout = without_comments(here / "layout.c")
    structs = re.findall(r"\bSTRUCT\((\w+), \d+\)", layout)
    compare("layout.c: struct", list(parsed.structs), structs, report)
    for struct in parsed.structs.values():
        names = re.findall(rf"\bFIELD\({struct.name}, (\w+), \d+, \d+\)", layout)
        declared = [name for name, _ in struct.fields]
        compare(f"layout.c: {struct.name}", declared, names, report)
        if names != declared and sorted(names) == sorted(declared):
            report.complain(f"layout.c: the fields of {struct.name} are in another order")

    values = dict(re.findall(r"\bVALUE\((\w+), (-?\d+)\)", without_comments(here / "values.c")))
    compare("values.c", list(parsed.constants), list(values), report)

    calls = " ".join(without_comments(path) for path in sorted((here / "calls").glob("*.c")))
    for name in parsed.functions:
        if not re.search(rf"\b{name}\(", calls):
            report.complain(f"calls/ never calls {name}")
    return report.finish("tables")


if __name__ == "__main__":
    sys.exit(main())
