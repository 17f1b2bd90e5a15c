"""Runs one scene of everything as it is built by many compilers for many machines, and compares one hash.

usage: matrix.py run GROUP... --build DIR    builds and runs groups of variants
       matrix.py table --build DIR           what was run last, as a table
       matrix.py renew --build DIR           writes expected.txt anew: only where a change of the numbers is meant

Every hash must be the one in expected.txt, section by section. DIR is a build directory of frm with its tests; variants are
built and results kept in DIR/determinism. Exit status: 0 all agree; 1 something differs or fails; 77 a group could not be
run because a tool is not there (1 if FRM_DETERMINISM_REQUIRE=1 is set, as scripts/test --full does).
"""

import argparse
import json
import os
import shlex
import shutil
import subprocess
import sys
import time

from zstd_source import Missing, zstd_source

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
DATA = os.path.join(ROOT, "tests", "data")
EXPECTED = os.path.join(HERE, "expected.txt")
SKIPPED = 77
# Threads that wait by spinning take each other's time where the machine is busy, the more in an emulator.
WAITING = {"OMP_WAIT_POLICY": "passive"}


def say(text):
    print(text, flush=True)


def need(*tools):
    """The paths of programs. Raises Missing."""
    found = [shutil.which(tool) for tool in tools]
    for tool, path in zip(tools, found):
        if not path:
            raise Missing(f"{tool} is not installed")
    return found


def read_hashes(text):
    """{section: hash} of a scene's output or of expected.txt."""
    lines = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if not lines or any(len(line) != 2 or len(line[1]) != 16 for line in lines):
        raise ValueError(f"these are not hashes: {text!r}")
    return dict(lines)


def expected():
    with open(EXPECTED, encoding="ascii") as file:
        return read_hashes(file.read())


class Runner:
    """Runs scenes, compares, and keeps what came out."""

    def __init__(self, build, group, jobs):
        self.build, self.group, self.jobs = build, group, jobs
        self.work = os.path.join(build, "determinism")
        self.rows, self.failed = [], False

    def files(self):
        folder = os.path.join(self.work, "files", self.group)
        os.makedirs(folder, exist_ok=True)
        return folder

    def check(self, command, environment=None):
        """A program that has no hashes, but says on its own whether all is as it should be."""
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                              env={**os.environ, **(environment or {})}, timeout=1800)
        self.failed |= done.returncode != 0
        say(f"  {'FAILED  ' if done.returncode else ''}{done.stdout.strip()}")

    def scene(self, variant, command, arguments=(), environment=None):
        """One run of the scene; `command` is how the program is started."""
        folder = self.files()
        label = " ".join([variant, *(a for a in arguments if not a.startswith("--"))])
        start = time.monotonic()
        done = subprocess.run([*command, "--data", DATA, "--work", folder, *arguments], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, env={**WAITING, **os.environ, **(environment or {})}, timeout=1800)
        row = {"group": self.group, "variant": variant, "arguments": " ".join(arguments), "hash": "", "differs": [],
               "seconds": round(time.monotonic() - start, 2)}
        try:
            if done.returncode != 0:
                raise ValueError(f"status {done.returncode}: {done.stderr.decode(errors='replace').strip()[-500:]}")
            got, want = read_hashes(done.stdout.decode("ascii")), expected()
            row["hash"] = got.get("all", "")
            row["differs"] = [name for name in want if got.get(name) != want[name] and name != "all"]
            if got != want and not row["differs"]:
                row["differs"] = ["all"]
        except ValueError as error:
            row["differs"] = [f"failed: {error}"]
        self.rows.append(row)
        self.failed |= bool(row["differs"])
        say(f"  {'DIFFERS' if row['differs'] else 'same'}  {row['hash'] or '-':16}  {row['seconds']:6.2f} s  {label} "
            f"{' '.join(row['differs'])}".rstrip())

    def configure_and_build(self, name, options, flags="-O3", environment=None, launcher=True, target="all"):
        """Builds frm without its bake, and the scene. Returns the build directory."""
        folder = os.path.join(self.work, name)
        command = ["cmake", "-G", "Ninja", "-S", ROOT, "-B", folder, "-DFRM_BUILD_BAKE=OFF", "-DFRM_BUILD_TESTS=OFF",
                   "-DFRM_BUILD_SCENE=ON", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"]
        command += [f"-DCMAKE_{language}_FLAGS_RELEASE={flags} -DNDEBUG" for language in ("C", "CXX")]
        if launcher and shutil.which("ccache"):
            command += [f"-DCMAKE_{language}_COMPILER_LAUNCHER=ccache" for language in ("C", "CXX")]
        for step in (command + options, ["cmake", "--build", folder, "-j", str(self.jobs), "--target", target]):
            done = subprocess.run(step, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                                  env={**os.environ, **(environment or {})})
            if done.returncode != 0:
                raise RuntimeError(f"{shlex.join(step)}\n{done.stdout[-3000:]}")
        return folder

    def objects(self, folder, prefix=""):
        """check_objects.py over a cross build's core and device."""
        objdump, nm = need(prefix + "objdump", prefix + "nm")
        found = [os.path.join(at, name) for room in ("core", "device")
                 for at, _, names in os.walk(os.path.join(folder, room)) for name in names if name.endswith((".o", ".obj"))]
        done = subprocess.run([sys.executable, "-B", os.path.join(HERE, "check_objects.py"), "--objdump", objdump, "--nm", nm,
                               *sorted(found)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.failed |= done.returncode != 0
        say(f"  {done.stdout.strip()}")

    def keep(self):
        folder = os.path.join(self.work, "results")
        os.makedirs(folder, exist_ok=True)
        with open(os.path.join(folder, self.group + ".json"), "w", encoding="utf-8") as file:
            json.dump(self.rows, file, indent=1)


def lines_of(command, environment=None):
    return subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True,
                          env={**os.environ, **(environment or {})}).stdout.split()


def every_set(run, variant, start, threads=(1, 2, 8), environment=None, best_alone=False):
    """Each instruction set of the (virtual) machine with one thread, the best one with several."""
    sets = lines_of([*start, "--list-instructions"], environment)
    for name in sets[-1:] if best_alone else sets:
        for count in threads if name == sets[-1] else (1,):
            run.scene(variant, start, ["--instructions", name, "--threads", str(count)], environment)
    return sets


def version_of(compiler):
    text = lines_of([compiler, "-dumpfullversion", "-dumpversion"])
    return text[0] if text else "?"


# ---- Groups: what this machine's own build gives -------------------------------------------------------------------


def here(run):
    """The build under test: its instruction sets and threads, and the shared library as a host has it."""
    program = os.path.join(run.build, "scene")
    every_set(run, "this build", [program], threads=range(1, 9))
    run.scene("this build, libfrm.so", [os.path.join(run.build, "scene_shared")], ["--threads", "2"])


def native(run, name, compiler, flags, options=(), quick=False):
    folder = run.configure_and_build(name, [f"-DCMAKE_C_COMPILER={compiler[0]}", f"-DCMAKE_CXX_COMPILER={compiler[1]}",
                                            *options], flags, target="scene")
    variant = f"{os.path.basename(compiler[1])} {version_of(compiler[1])} {flags}"
    every_set(run, variant, [os.path.join(folder, "scene")], threads=(2,) if quick else (1, 2, 8))


def gcc():
    return need("gcc", "g++")


def clang_options(compiler, run):
    """clang without its OpenMP builds the core without threads."""
    source = os.path.join(run.work, "openmp.cpp")
    os.makedirs(run.work, exist_ok=True)
    with open(source, "w", encoding="ascii") as file:
        file.write("#include <omp.h>\nint main() { return omp_get_max_threads() < 1; }\n")
    done = subprocess.run([compiler[1], "-fopenmp", source, "-o", os.path.join(run.work, "openmp")], stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL)
    if done.returncode == 0:
        return []
    say("  clang has no OpenMP here (libomp-dev): built without threads")
    return ["-DFRM_OPENMP=OFF"]


def debug(run):
    """Without optimisation."""
    native(run, "gcc-O0", gcc(), "-O0", quick=True)


def clang(run):
    """The other compiler."""
    compiler = need("clang", "clang++")
    native(run, "clang-O2", compiler, "-O2", clang_options(compiler, run), quick=True)


def optimised(run):
    """Both compilers, other levels of optimisation, and code for this very processor."""
    for flags in ("-O1", "-O2", "-Os", "-O3", "-O3 -march=native", "-O3 -flto"):
        native(run, "gcc" + flags.replace(" ", ""), gcc(), flags)
    compiler = need("clang", "clang++")
    options = clang_options(compiler, run)
    for flags in ("-O0", "-O1", "-O3", "-O3 -march=native"):
        native(run, "clang" + flags.replace(" ", ""), compiler, flags, options)


# ---- Groups: other machines ---------------------------------------------------------------------------------------


def older(run):
    """Older processors: one that the build asks more of than it has stops at once."""
    (qemu,) = need("qemu-x86_64-static")
    for cpu, best in (("Nehalem", "baseline"), ("Haswell", "avx2")):
        start = [qemu, "-cpu", cpu, os.path.join(run.build, "scene")]
        sets = every_set(run, f"qemu {cpu}", start, threads=(2,), best_alone=True)
        if sets[-1] != best:
            say(f"  DIFFERS  {cpu} should choose {best}, and chose {sets[-1]}")
            run.failed = True
        run.scene(f"qemu {cpu}, libfrm.so", [qemu, "-cpu", cpu, os.path.join(run.build, "scene_shared")])


def toolchain(name):
    return f"-DCMAKE_TOOLCHAIN_FILE={ROOT}/cmake/toolchains/{name}.cmake"


def arm64(run):
    """64-bit ARM with NEON."""
    qemu, compiler = need("qemu-aarch64-static", "aarch64-linux-gnu-g++")
    options = [toolchain("aarch64-linux-gnu"), "-DFRM_ZSTD_SOURCE=" + zstd_source(run.work)]
    start = [qemu, "-L", "/usr/aarch64-linux-gnu"]
    for flags in ("-O3", "-O0"):
        folder = run.configure_and_build("arm64" + flags, options, flags)
        variant = f"arm64 g++ {version_of(compiler)} {flags}"
        every_set(run, variant, [*start, os.path.join(folder, "scene")], (1, 2, 8) if flags == "-O3" else (2,))
        run.scene(variant + ", libfrm.so", [*start, "-E", f"LD_LIBRARY_PATH={folder}", os.path.join(folder, "scene_shared")],
                  ["--threads", "2"])
        run.check([*start, "-E", f"LD_LIBRARY_PATH={folder}", os.path.join(folder, "threads"), DATA, run.files()])
        run.objects(folder, "aarch64-linux-gnu-")


def windows(run):
    """64-bit Windows: frm.dll, and a C program that calls it."""
    wine, _, compiler = need("wine", "wineboot", "x86_64-w64-mingw32-g++-posix")
    options = [toolchain("x86_64-w64-mingw32"), "-DFRM_ZSTD_SOURCE=" + zstd_source(run.work)]
    # Paths that are not ASCII reach the files by the locale. No window, no menu entries, no download.
    environment = {"WINEPREFIX": os.path.join(run.work, "wine"), "WINEDEBUG": "-all", "LC_ALL": "C.UTF-8", "DISPLAY": "",
                   "WINEDLLOVERRIDES": "winemenubuilder.exe,mscoree,mshtml="}
    subprocess.run(["wineboot", "-i"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=300,
                   env={**os.environ, **environment})
    try:
        for flags in ("-O3", "-O0"):
            folder = run.configure_and_build("windows" + flags, options, flags)
            variant = f"mingw {version_of(compiler)} {flags}, wine"
            every_set(run, variant, [wine, os.path.join(folder, "scene.exe")], (1, 2, 8) if flags == "-O3" else (2,), environment,
                      best_alone=flags != "-O3")
            run.scene(variant + ", frm.dll", [wine, os.path.join(folder, "scene_shared.exe")], ["--threads", "2"], environment)
            run.check([wine, os.path.join(folder, "threads.exe"), DATA, run.files()], environment)
            run.objects(folder, "x86_64-w64-mingw32-")
    finally:
        subprocess.run(["wineserver", "-k"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                       env={**os.environ, **environment})


def wasm(run):
    """WebAssembly, without and with its 128-bit vectors."""
    (compiler,) = need("em++")
    node = shutil.which("node", path="/usr/bin") or need("node")[0]
    options = [toolchain("emscripten"), "-DFRM_OPENMP=OFF", "-DFRM_ZSTD_SOURCE=" + zstd_source(run.work)]
    environment = {"NODE_PATH": "/usr/share/nodejs"}
    os.environ.pop("EM_CACHE", None)
    # Older Emscriptens load files by fetch where they see one, which node's is not made for.
    start = [node, "--no-experimental-fetch"]
    if subprocess.run([*start, "-e", "0"], stderr=subprocess.DEVNULL).returncode != 0:
        start = [node]
    for name, flags in (("wasm", "-O3"), ("wasm-O0", "-O0"), ("wasm-simd128", "-O3 -msimd128")):
        folder = run.configure_and_build(name, options, flags, environment, launcher=False)
        run.scene(f"em++ {version_of(compiler)} {flags}, node", [*start, os.path.join(folder, "scene.js")])
        run.check([*start, os.path.join(folder, "threads.js"), DATA, run.files()])


GROUPS = {group.__name__: group for group in (here, debug, clang, optimised, older, arm64, windows, wasm)}


# ---- The command line ---------------------------------------------------------------------------------------------


def run_group(name, build, jobs):
    run = Runner(build, name, jobs)
    say(f"{name}: {GROUPS[name].__doc__}")
    try:
        GROUPS[name](run)
    except Missing as missing:
        say(f"  SKIPPED  {missing}")
        run.rows.append({"group": name, "variant": f"not run: {missing}", "arguments": "", "hash": "", "differs": [],
                         "seconds": 0})
        run.keep()
        return 1 if run.failed or os.environ.get("FRM_DETERMINISM_REQUIRE") == "1" else SKIPPED
    except (RuntimeError, OSError, subprocess.SubprocessError) as error:
        say(f"  FAILED  {error}")
        run.failed = True
    run.keep()
    if not run.rows:
        say("  FAILED  nothing was run")
        run.failed = True
    return 1 if run.failed else 0


def table(build):
    """Each variant on a line, its runs counted."""
    say("| build | runs | seconds a run | hash |\n| --- | --- | ---: | --- |")
    for name in GROUPS:
        path = os.path.join(build, "determinism", "results", name + ".json")
        if not os.path.exists(path):
            say(f"| {name} | not run | | |")
            continue
        with open(path, encoding="utf-8") as file:
            rows = json.load(file)
        for variant in dict.fromkeys(row["variant"] for row in rows):
            mine = [row for row in rows if row["variant"] == variant]
            words = [row["arguments"].replace("--instructions ", "").replace("--threads ", "") for row in mine]
            sets = dict.fromkeys(word.split()[0] for word in words if " " in word)
            threads = sorted({int(word.split()[-1]) for word in words if word} or {1})
            told = f"{', '.join(sets) or 'its own choice'}; threads {', '.join(map(str, threads))}"
            hashes = "; ".join(dict.fromkeys(row["hash"] + (" DIFFERS: " + " ".join(row["differs"]) if row["differs"] else "")
                                             for row in mine))
            seconds = sorted(row["seconds"] for row in mine)[len(mine) // 2]
            say(f"| {variant} | {told} | {seconds:.1f} | {hashes} |" if mine[0]["hash"] or mine[0]["differs"] else
                f"| {name}: {variant} | | | |")


def renew(build):
    program = os.path.join(build, "scene")
    folder = os.path.join(build, "determinism", "files", "renew")
    os.makedirs(folder, exist_ok=True)
    texts = {}
    for name in lines_of([program, "--list-instructions"]):
        texts[name] = subprocess.run([program, "--data", DATA, "--work", folder, "--instructions", name],
                                     stdout=subprocess.PIPE, check=True, text=True).stdout
    if len(set(texts.values())) != 1:
        sys.exit(f"instruction sets differ; nothing was written: {texts}")
    with open(EXPECTED, "w", encoding="ascii") as file:
        file.write("# What every build on every machine must give: `scene`, section by section. Written by matrix.py renew,\n"
                   "# where a change of the numbers is meant; the commit says so.\n" + texts["baseline"])
    say(f"wrote {EXPECTED}: {read_hashes(texts['baseline'])['all']}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=("run", "table", "renew"))
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=", ".join(GROUPS))
    parser.add_argument("--build", required=True, help="a build directory of frm with its tests")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="compilers at a time")
    options = parser.parse_args()
    build = os.path.abspath(options.build)
    unknown = [name for name in options.groups if name not in GROUPS]
    if unknown or (options.command == "run") != bool(options.groups):
        parser.error(f"run takes groups, of: {', '.join(GROUPS)}")
    if options.command == "table":
        return table(build)
    if options.command == "renew":
        return renew(build)
    statuses = [run_group(name, build, options.jobs) for name in options.groups]
    return 1 if 1 in statuses else max(statuses)


if __name__ == "__main__":
    sys.exit(main())
