"""The program takes the interface from libfrm: a second copy of it inside the program would have handles of its own,
which the library's functions do not know.

usage: check_program.py include/frm.h PROGRAM NM"""

import subprocess
import sys

import header


def main():
    path, program, nm = sys.argv[1:4]
    parsed = header.read(path)
    report = header.Report()
    # The dynamic table, because a stripped program has no other.
    output = subprocess.run([nm, "-D", "--format=posix", program], check=True, capture_output=True, text=True).stdout
    kinds = {line.split()[0].split("@")[0]: line.split()[1] for line in output.splitlines()}
    used = [name for name in parsed.functions if name in kinds]
    for name in used:
        if kinds[name] != "U":
            report.complain(f"{name} is defined in the program itself")
    if not used:
        report.complain("the program uses no function of the interface")
    return report.finish(f"{len(used)} functions used")


if __name__ == "__main__":
    sys.exit(main())
