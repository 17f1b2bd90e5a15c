"""Runs cases of the flow and keeps what they gave, so that a run that was stopped goes on where it was."""
from __future__ import annotations

import datetime
import fcntl
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import time

from flow_cases import mesh_of

# What the numbers depend on. Where one of these changes by more than a line of comment a case is measured again, unless its
# beginning still has the same bits.
SOLVER = ("bake/flow/*.h", "bake/flow/*.cpp", "bake/mesh/*.h", "bake/mesh/*.cpp", "bake/series/spectrum.*",
          "cli/flow.cpp")
# Of these, what reads a series that may be long: a beginning does not show its changes.
READS = ("bake/flow/flow.h", "bake/flow/solve.cpp", "bake/flow/statistics.*", "bake/series/spectrum.*", "cli/flow.cpp")


def solver_sources(root, patterns=SOLVER):
    return sorted(path for pattern in patterns for path in pathlib.Path(root).glob(pattern))


def solver_version(root, patterns=SOLVER):
    """A hash of the solver's sources, without the lines that are only a comment and the space at the ends of lines."""
    digest = hashlib.sha256()
    for path in solver_sources(root, patterns):
        lines = [line.strip() for line in path.read_text().splitlines()]
        kept = [line for line in lines if line and not line.startswith("//")]
        digest.update("\n".join([path.relative_to(root).as_posix(), *kept, ""]).encode())
    return digest.hexdigest()[:16]


def write_whole(path, content):
    """The file is the old one or the new one, never a part, whenever this process ends."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    with open(part, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    os.replace(part, path)


def say(text):
    print(f"[{datetime.datetime.now():%H:%M:%S}] {text}", flush=True)


def lock(out, program):
    """Makes the folder `out`; no other may work in it while the file that this returns is open."""
    out.mkdir(parents=True, exist_ok=True)
    file = open(out / "lock", "w")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        sys.exit(f"{program}: another one is at work in {out}")
    return file


def machine():
    model = "unknown processor"
    try:
        with open("/proc/cpuinfo") as lines:
            model = next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return f"{model}, {len(os.sched_getaffinity(0))} cores"


def commit(root):
    """The commit that is checked out; "+" when the solver's sources are not the commit's."""
    def git(*words):
        return subprocess.run(["git", "-C", str(root), *words], capture_output=True, text=True)
    name = git("rev-parse", "--short=12", "HEAD")
    if name.returncode:
        return "no git"
    changed = git("status", "--porcelain", "--", *{str(path.relative_to(root)) for path in solver_sources(root)})
    return name.stdout.strip() + ("+" if changed.stdout.strip() else "")


def read_object(path):
    """Of a JSON file; empty where there is none."""
    try:
        found = json.loads(path.read_text())
    except (OSError, ValueError):
        found = {}
    return found if isinstance(found, dict) else {}


class Stopped(Exception):
    """The program was told to stop; the case is not done."""


class Runs:
    """`known`: a file of records that another machine may have made; a case that is not in `out` may be there."""

    def __init__(self, out, program, root, known):
        self.out, self.program = pathlib.Path(out), program
        self.known = read_object(known)
        self.solver, self.commit, self.machine = solver_version(root), commit(root), machine()
        self.reads = solver_version(root, READS)
        self.meshes = {}

    def mesh(self, case):
        """The hash of the case's mesh; the mesh is in its place."""
        if case.body not in self.meshes:
            content, path = mesh_of(case.body), self.out / case.mesh
            if not path.is_file() or path.read_bytes() != content:
                write_whole(path, content)
            self.meshes[case.body] = hashlib.sha256(content).hexdigest()
        return self.meshes[case.body]

    def path(self, case):
        return self.out / "cases" / (case.name + ".json")

    def load(self, case, look=False):
        """What the case gave with this solver, mesh and command line, or None. With `look`, one whose steps are by other
        sources is this solver too if the case begins with the same bits: a run has the same bits whatever the threads, and
        other steps show in its first ones."""
        records = [record for record in (read_object(self.path(case)), self.known.get(case.name, {}))
                   if record.get("command") == case.command() and record.get("mesh_sha256") == self.mesh(case)]
        for record in records:
            if record.get("solver") == self.solver:
                return record
        for record in records if look else ():
            if record.get("reads") == self.reads and record.get("begins") and self.begins(case) == record["begins"]:
                record["solver"] = self.solver
                self.keep(case, record)
                return record
        return None

    def keep(self, case, record):
        write_whole(self.path(case), json.dumps(record, indent=2).encode() + b"\n")

    def ask(self, words, longest=None):
        """What the program says to a command line, given `longest` seconds."""
        return subprocess.run([str(self.program), *words], cwd=self.out, capture_output=True, text=True, errors="replace",
                              timeout=longest, stdin=subprocess.DEVNULL)

    def begins(self, case):
        """A hash of all that the case's first length travelled gives, and of its run on half the resolution; or None."""
        words = case.command()
        for option in ("--start-up", "--duration"):
            words[words.index(option) + 1] = "0.5"
        result = self.outcome(self.ask(words)).get("result")
        if result is None:
            return None
        bits = {key: value for key, value in result.items() if key not in ("seconds", "mlups", "bytes")}
        return hashlib.sha256(json.dumps(bits, sort_keys=True).encode()).hexdigest()[:16]

    def run(self, case, longest):
        """Runs the case for `longest` seconds at most and keeps what it gave, or why it failed."""
        record = {"name": case.name, "command": case.command(), "mesh_sha256": self.mesh(case), "solver": self.solver,
                  "reads": self.reads, "commit": self.commit, "machine": self.machine,
                  "started": datetime.datetime.now().astimezone().isoformat(timespec="seconds")}
        began = time.monotonic()
        try:
            record.update(self.outcome(self.ask(case.command(), longest)))
        except subprocess.TimeoutExpired:
            record["error"] = f"not done after {longest:g} s"
        except OSError as error:
            record["error"] = f"{self.program}: {error.strerror}"
        record["wall_seconds"] = round(time.monotonic() - began, 3)
        self.keep(case, record)
        if "error" not in record:
            record["begins"] = self.begins(case)
            self.keep(case, record)
        return record

    @staticmethod
    def outcome(done):
        lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
        notes = [line.removeprefix("note: ") for line in lines if line.startswith("note: ")]
        said = "; ".join(line for line in lines if not line.startswith("note: "))[-500:]
        if done.returncode:
            how = f"signal {-done.returncode}" if done.returncode < 0 else f"exit status {done.returncode}"
            return {"notes": notes, "error": f"{how}: {said}" if said else how}
        try:
            result = json.loads(done.stdout)
        except ValueError:
            result = None
        if not isinstance(result, dict):
            return {"notes": notes, "error": "what it printed is not a JSON object"}
        if result.get("ending") == "cancelled":
            raise Stopped
        return {"notes": notes, "result": result}
