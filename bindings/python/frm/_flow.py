"""What `frm flow --report` wrote, read and checked. frm.flow_report says what the files hold."""
from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from .report import Unusable

FORMAT = "frm flow report 1"
_COLUMNS = 13  # of series.csv
_NEEDED = ("cd", "uncertainty", "uncertainty_parts", "ending", "blocks", "interval", "length", "area", "reynolds")
_NEEDED_REPORT = ("mesh", "direction", "speed", "density", "spin", "axes", "lift_axis", "slices", "reference_length",
                  "fastest", "resolution", "duration")


def knows_grid(one: dict) -> bool:
    """Whether the grid's part of a flow's uncertainty was measured: without it the flow is less certain than it says."""
    return one["uncertainty_parts"]["grid"] is not None


@dataclass(frozen=True)
class Slice:
    normal: int  # axis of the stream's frame
    place: float  # along it, m
    x: np.ndarray  # of the columns, along the stream, m
    across: np.ndarray  # of the rows, m
    speed: np.ndarray  # [row][column], share of the stream's; NaN in the body
    pressure: np.ndarray  # coefficient
    extent: np.ndarray | None = None  # of the body's mesh, as `body`, where it is known

    @property
    def other(self) -> int:
        """The axis along which rows go."""
        return 3 - self.normal

    @cached_property
    def body(self) -> np.ndarray:
        """Its extent as (x low, x high, across low, across high); the middle of the slice where it is not cut. Cells
        alone do not tell that of a body thinner than they are."""
        if self.extent is not None:
            return self.extent
        rows, columns = np.nonzero(np.isnan(self.speed))
        if not len(rows):
            rows, columns = np.array([len(self.across) // 2]), np.array([len(self.x) // 2])
        return np.array([self.x[columns.min()], self.x[columns.max()],
                         self.across[rows.min()], self.across[rows.max()]])


@dataclass(frozen=True)
class Flow:
    json: dict
    time: np.ndarray  # s, from the beginning of the series
    force: np.ndarray  # [sample][3], N
    torque: np.ndarray  # [sample][3], N m, about the mesh's origin
    slices: list[Slice]

    @property
    def report(self) -> dict:
        return self.json["report"]

    @property
    def spin_alone(self) -> bool:
        return self.report["speed"] == 0

    @property
    def travelled(self) -> np.ndarray:
        """Time in lengths: of the stream's way, of the fastest point's where only spin drives the flow."""
        return self.time * self.report["fastest"] / self.json["length"]

    @property
    def coefficients(self) -> dict[str, np.ndarray]:
        """The curves to show, by name: of drag and lift, or the torque in N m where only spin drives the flow."""
        report = self.report
        if self.spin_alone:
            axis = np.array(report["spin"]) / np.linalg.norm(report["spin"])
            return {"torque": self.torque @ axis}
        unit = 0.5 * report["density"] * report["speed"] ** 2 * self.json["area"]
        curves = {"drag": self.force @ np.array(report["direction"]) / unit}
        axis = np.array(report["lift_axis"])
        if axis.any():
            curves["lift"] = self.force @ axis / unit
        return curves


def read(folder: Path) -> Flow:
    try:
        flow = json.loads((folder / "flow.json").read_text(encoding="utf-8"))
    except ValueError as error:
        raise Unusable(f"{folder / 'flow.json'} is not JSON: {error}") from None
    report = flow.get("report") if isinstance(flow, dict) else None
    if not isinstance(report, dict) or report.get("format") != FORMAT:
        raise Unusable(f"{folder / 'flow.json'} is not the report of a flow: its format is not \"{FORMAT}\"")
    missing = [key for key in _NEEDED if key not in flow] + [key for key in _NEEDED_REPORT if key not in report]
    if missing:
        raise Unusable(f"{folder / 'flow.json'} lacks {', '.join(missing)}")
    return Flow(flow, *_series(folder / "series.csv"), _slices(folder / "slices.f32", report["slices"]))


def _series(path: Path):
    try:
        rows = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
    except ValueError as error:
        raise Unusable(f"{path}: {error}") from None
    if rows.shape[0] < 1 or rows.shape[1] != _COLUMNS:
        raise Unusable(f"{path}: {_COLUMNS} columns and at least one row are needed")
    return rows[:, 0], rows[:, 1:4], rows[:, 10:13]


def _slices(path: Path, described: list[dict]) -> list[Slice]:
    values = np.fromfile(path, dtype="<f4")
    slices = []
    for one in described:
        count = one["rows"] * one["columns"]
        if one["offset"] + 2 * count > len(values):
            raise Unusable(f"{path}: is too short for the slices that flow.json names")
        speed, pressure = (values[one["offset"] + part * count:][:count].reshape(one["rows"], one["columns"])
                           for part in (0, 1))
        low, spacing, normal = one["low"], one["spacing"], one["normal"]
        slices.append(Slice(normal, low[normal], low[0] + spacing * np.arange(one["columns"]),
                            low[3 - normal] + spacing * np.arange(one["rows"]), speed, pressure))
    return slices
