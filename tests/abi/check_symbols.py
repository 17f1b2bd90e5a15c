"""What the shared library shows: exactly the header's functions, the right SONAME, no needs but the allowed ones.

usage: check_symbols.py include/frm.h libfrm.so NM READELF [further allowed library...]"""

import pathlib
import re
import subprocess
import sys

import header

# libfrm links zstd and OpenMP and nothing else; the rest is what every C++ program needs.
ALLOWED = ["libzstd", "libgomp", "libstdc++", "libm", "libgcc_s", "libc", "ld-linux", "libpthread"]


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def main():
    path, library, nm, readelf = sys.argv[1:5]
    parsed = header.read(path)
    report = header.Report()

    exported = {}
    for line in run(nm, "-D", "--defined-only", "--format=posix", library).splitlines():
        name, kind = line.split()[:2]
        exported[name] = kind
    for name in parsed.functions:
        if name not in exported:
            report.complain(f"{name} is in the header but is not exported")
        elif exported[name] != "T":
            report.complain(f"{name} is exported as '{exported[name]}', not as a function of its own (T)")
    for name in exported:
        if name not in parsed.functions:
            report.complain(f"{name} is exported but is not in the header")

    dynamic = run(readelf, "-d", "-W", library)
    soname = re.findall(r"\(SONAME\).*\[(.*)\]", dynamic)
    version = parsed.version or header.read(pathlib.Path(path).with_name("frm.h")).version
    expected = f"{pathlib.Path(library).name.split('.so')[0]}.so.{version[0]}"
    if soname != [expected]:
        report.complain(f"the SONAME is {soname}, not {expected}")
    allowed = ALLOWED + sys.argv[5:]
    for needed in re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic):
        if re.split(r"\.so|-x86|-aarch", needed)[0] not in allowed:
            report.complain(f"the library needs {needed}")
    if "(TEXTREL)" in dynamic:
        report.complain("the library has text relocations")
    return report.finish(f"{len(exported)} exported symbols")


if __name__ == "__main__":
    sys.exit(main())
