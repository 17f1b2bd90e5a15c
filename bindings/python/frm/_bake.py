"""What `frm bake --report` wrote, read and checked. frm.bake_report says what the files hold."""
from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from ._flow import Flow, Slice
from .report import Unusable

FORMAT = "frm bake report 1"
_NEEDED = ("mesh", "options", "body", "map", "errors", "budgets", "surface", "means", "fluctuation_directions",
           "fluctuations", "fluctuation_faces", "flows", "notes", "seconds")
_NEEDED_FLOW = ("name", "kind", "direction", "speed", "fastest", "left_out", "lift_axis", "cd", "strouhal",
                "uncertainty", "uncertainty_parts", "samples", "interval", "cells", "seconds", "area", "length",
                "reynolds", "reynolds_solved", "axes", "images", "series")


@dataclass(frozen=True)
class Bake:
    json: dict
    values: np.ndarray  # of bake.f32
    path: Path  # of bake.f32

    def array(self, described: dict) -> np.ndarray:
        shape = [int(size) for size in described["shape"]]
        first, count = int(described["offset"]), int(np.prod(shape))
        if first < 0 or count < 0 or first + count > len(self.values):
            raise Unusable(f"{self.path}: is too short for what bake.json names")
        return self.values[first:first + count].reshape(shape).astype(float)

    def surface(self, name: str) -> np.ndarray:
        return self.array(self.json["surface"][name])

    @property
    def options(self) -> dict:
        return self.json["options"]

    @property
    def map(self) -> dict:
        return self.json["map"]

    @property
    def errors(self) -> dict:
        return self.json["errors"]

    @property
    def budgets(self) -> dict:
        return self.json["budgets"]

    @property
    def flows(self) -> list[dict]:
        return self.json["flows"]

    @cached_property
    def base(self) -> list[dict]:
        """The flows that the map's directions at the base speed come of."""
        return [flow for flow in self.flows if flow["kind"] == "stream" and flow["speed"] == self.options["speed"]]

    @cached_property
    def drag(self) -> np.ndarray:
        """N along the stream, in each of the map's directions."""
        means = self.array(self.json["means"])
        return np.einsum("ij,ij->i", means[:, :3], means[:, 3:])

    @cached_property
    def largest_force(self) -> float:
        """N, the mean in the direction where it is largest."""
        return float(np.linalg.norm(self.array(self.json["means"])[:, 3:], axis=1).max())

    @cached_property
    def swings(self) -> np.ndarray:
        """[direction][sample][3], N: the fluctuation of the force on the whole body, about a mean of zero."""
        directions = len(self.array(self.json["fluctuation_directions"]))
        return self.array(self.json["fluctuations"]).reshape(directions, -1, 3)

    @cached_property
    def rms(self) -> np.ndarray:
        """N, of the fluctuation in each of its directions."""
        return np.sqrt((self.swings ** 2).sum(2).mean(1))

    @cached_property
    def neighbours(self):
        """(pairs of the fluctuation's directions, how well the two of each swing together, from -1 to 1; NaN where one
        does not swing)"""
        faces = self.array(self.json["fluctuation_faces"]).astype(int)
        sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        pairs = np.unique(np.sort(sides, axis=1), axis=0)
        products = np.einsum("psk,psk->p", self.swings[pairs[:, 0]], self.swings[pairs[:, 1]]) / self.swings.shape[1]
        sizes = self.rms[pairs].prod(1)
        with np.errstate(invalid="ignore", divide="ignore"):
            return pairs, np.where(sizes > 0, products / sizes, np.nan)

    def flow(self, one: dict) -> Flow:
        """One of `flows` as the page of a flow has it."""
        series = self.array(one["series"])
        force, torque = series[:, :3], series[:, 3:]
        spin = one["kind"] == "spin"
        if spin:  # about the body's centroid, where the axis is
            torque = torque - np.cross(self.json["body"]["centroid"], force)
        report = {"speed": 0 if spin else one["speed"], "spin": np.array(one["direction"]) * one["speed"] * spin,
                  "direction": one["direction"], "density": self.options["density"], "lift_axis": one["lift_axis"],
                  "fastest": one["fastest"], "axes": one["axes"], "reference_length": one["reference_length"]}
        slices = []
        if "slice" in one:
            speed, low, spacing = self.array(one["slice"]), one["slice"]["low"], one["slice"]["spacing"]
            normal = one["slice"]["normal"]
            # The last ones of a frame that turns may lie beyond its grid: there is no body there.
            water = np.isfinite(speed)
            speed = speed[:max(np.flatnonzero(water.any(1)), default=0) + 1,
                          :max(np.flatnonzero(water.any(0)), default=0) + 1]
            seen = self.surface("vertices") @ np.array([one["axes"][0], one["axes"][3 - normal]]).T
            slices.append(Slice(normal, low[normal], low[0] + spacing * np.arange(speed.shape[1]),
                                low[3 - normal] + spacing * np.arange(speed.shape[0]), speed,
                                np.full(speed.shape, np.nan), np.stack([seen.min(0), seen.max(0)]).T.ravel()))
        return Flow({**one, "report": report}, one["interval"] * np.arange(len(force)), force, torque, slices)


def read(folder: Path) -> Bake:
    path = folder / "bake.json"
    try:
        bake = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise Unusable(f"{path} is not JSON: {error}") from None
    if not isinstance(bake, dict) or bake.get("format") != FORMAT:
        raise Unusable(f"{path} is not the report of a bake: its format is not \"{FORMAT}\"")
    missing = [key for key in _NEEDED if key not in bake]
    missing += [f"flows.{key}" for key in _NEEDED_FLOW if any(key not in flow for flow in bake.get("flows", []))]
    if missing or not bake["flows"]:
        raise Unusable(f"{path} lacks {', '.join(missing or ['flows'])}")
    return Bake(bake, np.fromfile(folder / "bake.f32", dtype="<f4"), folder / "bake.f32")


def standard_error(values: np.ndarray) -> float:
    """Of the mean: as the solver has it, the largest answer of batch means over 2, 4, ... 32 batches (docs/flow.md)."""
    largest, batches = 0.0, 2
    while batches <= 32 and 2 * batches <= len(values):
        edges = np.arange(batches + 1) * len(values) // batches
        means = np.add.reduceat(values, edges[:-1]) / np.diff(edges)
        largest = max(largest, float(means.std(ddof=1)) / batches ** 0.5)
        batches *= 2
    return largest


def running(values: np.ndarray, points: int = 60):
    """(samples, mean of so many first ones, its standard error)"""
    counts = np.unique(np.linspace(min(8, len(values)), len(values), points).astype(int))
    return counts, np.cumsum(values)[counts - 1] / counts, np.array([standard_error(values[:n]) for n in counts])


class Lattice:
    """The octahedral lattice of directions of a frequency n (docs/format.md), and what lies between them."""

    def __init__(self, frequency: int):
        self.n = n = frequency
        span = np.arange(-n, n + 1)
        points = np.array(np.meshgrid(span, span, span, indexing="ij")).reshape(3, -1).T
        self.points = points[np.abs(points).sum(1) == n]
        self._index = np.full((2 * n + 3,) * 3, -1)
        self._index[tuple((self.points + n).T)] = np.arange(len(self.points))

    def interpolate(self, directions: np.ndarray, values: np.ndarray) -> np.ndarray:
        """`values` are those of the lattice's directions."""
        e = np.asarray(directions, float)
        scaled = np.abs(e) * self.n / np.abs(e).sum(1, keepdims=True)
        cell = np.minimum(np.floor(scaled), self.n).astype(int)
        part = scaled - cell
        rest = self.n - cell.sum(1)  # 0, 1 or 2: on a corner, in a face that points up, in one that points down
        ones, none = np.eye(3, dtype=int), np.zeros(3, dtype=int)
        signs = np.where(e < 0, -1, 1)
        out, total = np.zeros(len(e)), np.zeros(len(e))
        for which, corners, weight in ((0, [none], lambda k: np.ones(len(e))), (1, ones, lambda k: part[:, k]),
                                       (2, 1 - ones, lambda k: 1 - part[:, k])):
            for k, corner in enumerate(corners):
                at = (cell + corner) * signs + self.n
                index = self._index[tuple(np.clip(at, 0, 2 * self.n).T)]
                share = np.where((rest == which) & (index >= 0), np.maximum(weight(k), 0), 0)
                out += share * values[index]
                total += share
        return out / np.where(total > 0, total, 1)
