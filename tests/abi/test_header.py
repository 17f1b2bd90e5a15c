"""Whether the checks see what they are there for: each fault is put into a copy of the header, and must be found.

usage: test_header.py include/frm.h"""

import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
TICK = "FRM_API frm_status FRM_CALL frm_world_tick("

# (what is done to the header, the check, its last argument, what it must say)
FAULTS = [
    ("a function without a comment", r"( \*/|\*/)\n(?=" + re.escape(TICK) + ")", "\\1\n\n",
     "check_header.py", "frm_world_tick has no comment"),
    ("a function without a thread tag", r"Counters\. \[realtime\]", "Counters.",
     "check_header.py", "frm_world_get_stats carries 0 thread tags"),
    ("a function with two tags", r"Counters\. \[realtime\]", "Counters. [realtime] [any]",
     "check_header.py", "frm_world_get_stats carries 2 thread tags"),
    ("a struct by value", r"frm_world_tick\(frm_world world, float dt\)", "frm_world_tick(frm_pose pose)",
     "check_header.py", "frm_pose pose does not go by pointer"),
    ("a type of no fixed width", r"uint32_t hash_interval;", "long hash_interval;",
     "check_header.py", "frm_recorder_def.hash_interval is of type long"),
    ("a new function", re.escape(TICK), "FRM_API frm_status FRM_CALL frm_world_tock(frm_world world);\n" + TICK,
     "check_tables.py", "calls/ never calls frm_world_tock"),
    ("a new field", r"uint32_t hash_interval;", "uint32_t hash_interval; uint32_t more;",
     "check_tables.py", "frm_recorder_def is missing: more"),
    ("fields in another order", r"float x, y, z, w;", "float w, x, y, z;",
     "check_tables.py", "the fields of frm_quaternion are in another order"),
    ("a new struct", r"typedef struct frm_twist", "typedef struct frm_more { float x; } frm_more; typedef struct frm_twist",
     "check_tables.py", "struct is missing: frm_more"),
    ("a new constant", r"FRM_SURFACE_NONE = 1", "FRM_SURFACE_NONE = 1, FRM_SURFACE_MORE = 2",
     "check_tables.py", "values.c is missing: FRM_SURFACE_MORE"),
]


def run(check, header):
    arguments = [str(header)] + ([str(HERE)] if check == "check_tables.py" else [])
    result = subprocess.run([sys.executable, "-B", str(HERE / check), *arguments], capture_output=True, text=True)
    return result.returncode, result.stdout + result.stderr


def main():
    text = pathlib.Path(sys.argv[1]).read_text(encoding="utf-8")
    failures = 0
    with tempfile.TemporaryDirectory() as directory:
        copy = pathlib.Path(directory) / "frm.h"
        for what, pattern, replacement, check, expected in FAULTS:
            changed, count = re.subn(pattern, lambda m: m.expand(replacement), text, count=1)
            copy.write_text(changed, encoding="utf-8")
            status, output = run(check, copy)
            if count != 1 or status == 0 or expected not in output:
                failures += 1
                print(f"wrong: {check} does not see {what} ({count} changes, status {status}):\n{output}")
    print(f"{len(FAULTS)} faults: {failures} not seen")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
