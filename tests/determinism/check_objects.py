"""Checks compiled objects for what would give other bits elsewhere: instructions that round once where others round twice
(fused multiply-add), or approximately (reciprocals), or to 80 bits (x87), and calls of C library functions that are not
exact.

usage: check_objects.py --objdump PROGRAM --nm PROGRAM OBJECT... (or @FILE, with an object on each line)

Exit status: 0 nothing found; 1 found; 2 the check itself could not be done.
"""

import argparse
import re
import subprocess
import sys

# Mnemonics, by the architecture that objdump names in its first lines.
FORBIDDEN = {
    "x86-64": [
        (r"v4?fn?m(add|sub)(sub|add)?[0-9ps]|vf(c)?maddc|vfmaddsub|vfmsubadd|vdpbf16", "a fused multiply-add"),
        (r"v?r(cp|sqrt)(14|28)?[ps][sh]", "an approximate reciprocal"),
        (r"f(i?ld|i?st|i?add|i?mul|i?subr?|i?divr?|sqrt|chs|abs|prem|rndint|scale|u?comi?)p?[slt]?p?$", "x87"),
    ],
    "aarch64": [
        (r"fn?m(add|sub)$|fml[as]l?2?$|fcmla|bfml|bfmmla|fmmla", "a fused multiply-add"),
        (r"fr(ecp|sqrt)[esx]$|ur(ecpe|sqrte)", "an approximate reciprocal"),
    ],
}

# Exact, by IEEE 754 or by being no arithmetic.
EXACT = {"sqrt", "floor", "ceil", "trunc", "round", "rint", "nearbyint", "lround", "llround", "lrint", "llrint", "fabs",
         "fmin", "fmax", "copysign", "fmod", "remainder", "ldexp", "scalbn", "frexp", "modf", "nextafter", "ilogb", "logb"}
INEXACT = {"sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sincos", "sinh", "cosh", "tanh", "asinh", "acosh",
           "atanh", "exp", "exp2", "exp10", "expm1", "log", "log2", "log10", "log1p", "pow", "cbrt", "hypot", "fma", "erf",
           "erfc", "tgamma", "lgamma", "gamma", "j0", "j1", "jn", "y0", "y1", "yn", "fdim", "drem"}


def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace")
    if done.returncode != 0:
        sys.exit(f"cannot be checked: {' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


def architecture(text):
    for line in text.splitlines():
        if "file format" in line:
            name = line.split("file format")[1].strip()
            if "x86-64" in name:
                return "x86-64"
            if "aarch64" in name:
                return "aarch64"
            sys.stderr.write(f"cannot be checked: objects of the format {name}\n")
            sys.exit(2)
    sys.stderr.write("cannot be checked: objdump does not name a format\n")
    sys.exit(2)


def instructions(text):
    """(function, mnemonic) of each instruction of a disassembly."""
    function = "?"
    for line in text.splitlines():
        head = re.match(r"[0-9a-f]+ <(.*)>:$", line)
        if head:
            function = head.group(1)
            continue
        parts = line.split("\t")
        if len(parts) < 2 or not re.match(r"\s*[0-9a-f]+:$", parts[0]):
            continue
        # Prefixes (`data16`, `{evex}`, `lock`) come before the name of an instruction.
        for word in parts[1].split():
            if word not in ("data16", "lock", "rep", "repz", "repnz", "notrack", "bnd", "cs", "ds", "addr32") and word[0] != "{":
                yield function, word
                break


def faults_of(objdump, nm, path):
    """Texts that say what is wrong with an object, and how many instructions it has."""
    text = run([objdump, "-d", "--no-show-raw-insn", path])
    rules = [(re.compile(rule), what) for rule, what in FORBIDDEN[architecture(text)]]
    count, found = 0, {}
    for function, name in instructions(text):
        count += 1
        for rule, what in rules:
            if rule.match(name):
                found.setdefault((what, name, function), 0)
                found[(what, name, function)] += 1
    faults = [f"{what}: {name}, {times} times in {function}" for (what, name, function), times in found.items()]
    for line in run([nm, "-u", path]).splitlines():
        symbol = line.split()[-1].split("@")[0] if line.split() else ""
        plain = re.sub(r"^(__imp_)?_*", "", symbol)
        plain = re.sub(r"_finite$", "", plain)
        names = {plain, re.sub(r"[fl]$", "", plain)}
        if names & INEXACT and not names & EXACT:
            faults.append(f"a function of the C library that is not exact: {symbol}")
    return faults, count


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     fromfile_prefix_chars="@")
    parser.add_argument("--objdump", required=True)
    parser.add_argument("--nm", required=True)
    parser.add_argument("objects", nargs="+")
    options = parser.parse_args()
    total, wrong = 0, 0
    for path in options.objects:
        faults, count = faults_of(options.objdump, options.nm, path)
        total += count
        for fault in faults:
            print(f"{path}: {fault}")
        wrong += len(faults)
    if total == 0:
        sys.stderr.write("cannot be checked: there is no instruction in these objects\n")
        return 2
    print(f"{len(options.objects)} objects, {total} instructions: {wrong} found that give other bits elsewhere")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
