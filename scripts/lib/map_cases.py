"""What scripts/validate-map bakes and asks of the maps.

A bake, a direct run or a question to a map is a step: a command line of the program and what it printed. To tune one, edit
its line here: what is asked with other words is asked again, the rest stays.
"""
from __future__ import annotations

import math
import pathlib
import shutil
import subprocess
from dataclasses import dataclass

from flow_cases import sphere

ROCK = "/usr/share/assimp/models/3DS/fels.3ds"


@dataclass(frozen=True)
class Body:
    title: str
    mesh: str
    options: tuple[str, ...] = ()


BODIES = {
    "plate": Body("box 8 x 1 x 30 cm", "plate.glb"),
    "paddle": Body("paddle", "paddle.glb"),
    "rock": Body("a rock from outside (Debian's assimp-testmodels, fels.3ds), no symmetry", "rock.glb", ("--speed", "0.05")),
    "sphere": Body("sphere 10 cm", "sphere.glb"),
}


@dataclass(frozen=True)
class Bake:
    name: str
    body: str
    quality: str
    options: tuple[str, ...] = ()
    held_out: int = 0  # directions that are compared with direct runs
    longest: float = 0  # s on two cores, of the issue; 0: none asked
    high: bool = False  # hours: only with --high
    asked: tuple[float, float] | None = None  # rms and worst error of directions held out
    kilobytes: float = 0  # at most


DRAFT, STANDARD, HIGH = "draft", "standard", "high"
BAKES = [
    Bake("plate-draft", "plate", DRAFT, held_out=8, longest=60),
    Bake("paddle-draft", "paddle", DRAFT, held_out=8, longest=60),
    Bake("rock-draft", "rock", DRAFT, held_out=8, longest=60),
    Bake("sphere-draft", "sphere", DRAFT, longest=60),
    Bake("plate-standard", "plate", STANDARD, held_out=8, longest=900, asked=(0.06, 0.15), kilobytes=300),
    Bake("paddle-standard", "paddle", STANDARD, held_out=8, asked=(0.06, 0.15), kilobytes=300),
    Bake("rock-standard", "rock", STANDARD, held_out=8, longest=3600, asked=(0.06, 0.15)),
    Bake("sphere-standard", "sphere", STANDARD, longest=600),
    Bake("plate-high", "plate", HIGH, held_out=8, asked=(0.03, 0.08), kilobytes=300, high=True),
    Bake("paddle-high", "paddle", HIGH, held_out=8, asked=(0.03, 0.08), kilobytes=300, high=True),
    Bake("rock-high", "rock", HIGH, held_out=8, asked=(0.03, 0.08), high=True),
]


def held_out_directions(count):
    """All round, evenly, and none on an axis or in a plane of the lattice: a spiral, turned out of the axes."""
    golden = math.pi * (3 - math.sqrt(5))
    out = []
    for i in range(count):
        z = 1 - (2 * i + 1) / count
        r = math.sqrt(1 - z * z)
        x, y = r * math.cos(golden * i + 0.4), r * math.sin(golden * i + 0.4)
        c, s = math.cos(0.3), math.sin(0.3)  # about x, then about y
        y, z = c * y - s * z, s * y + c * z
        c, s = math.cos(0.5), math.sin(0.5)
        out.append((c * x + s * z, y, -s * x + c * z))
    return out


LEAST_SWING = 0.005  # of the largest mean force, which is what a map may err by rounding: below, a ratio is one of nothings

# Direct runs, in lengths of the map: by then the wake is no longer that of the start (docs/bake.md), and some ten windows of
# a draft tell its strength to 10 %.
LONG_START, LONG_RECORD, LONG_PERIODS = 34, 80, 4.25


def long_duration(info):
    return max(LONG_RECORD, LONG_PERIODS * info["provenance"]["period_lengths"])


# Several speeds: a sphere 10 cm across in water, Reynolds number = speed * 1e5.
SPEEDS = ("0.001", "0.00316", "0.01", "0.0316", "0.1")
BASE_SPEED = "0.01"
ASKED_REYNOLDS = (150, 500, 2000, 7000)
SPEED_PERCENT = 5

# Spin: rad/s about the centroid.
SPIN_AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "xy": (0.7071067811865476, 0.7071067811865476, 0)}
SPIN_PERCENT = 10


def mesh_of(body, root, folder):
    """The mesh's file; made in `folder` where it is not one of the samples."""
    mesh = BODIES[body].mesh
    sample = root / "samples" / "meshes" / mesh
    if body == "sphere":  # finer than the sample: its facets must not count
        path = folder / mesh
        path.write_bytes(sphere(0.1).glb())
        return path
    if sample.is_file():
        return sample
    path = folder / mesh
    if not path.is_file():
        if not shutil.which("assimp") or not pathlib.Path(ROCK).is_file():
            raise SystemExit("validate-map: needs Debian's assimp-utils and assimp-testmodels: sudo apt-get install them")
        subprocess.run(["assimp", "export", ROCK, str(path), "-f", "glb2"], check=True, stdout=subprocess.DEVNULL)
    return path
