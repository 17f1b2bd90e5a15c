"""What a report needs of a recording, from replaying it twice: every tick's forces, then a few frames."""
from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Optional

import numpy as np

from ._abi import MapInfo, Part, ReplayInfo, ReplayStepResult, Status, WaterDef
from ._base import Context, Error
from ._progress import Progress
from ._recording import Replay
from ._world import Body

PARTS = ("total", "buoyancy", "pressure", "friction", "gravity")
STATES = ("wet_area", "displaced_volume", "relative_speed", "reynolds", "wet_sources")


@dataclass
class BodySeries:
    """One body over all ticks; rows of ticks in which the body was not there are NaN."""
    index: int
    force: np.ndarray  # [tick, part of PARTS, axis], N
    torque: np.ndarray  # the same, N m
    state: np.ndarray  # [tick, one of STATES]
    position: np.ndarray  # [tick, axis], m
    speed: np.ndarray  # of the origin, m/s

    @property
    def magnitude(self) -> np.ndarray:
        """Of the total force, N."""
        return np.linalg.norm(self.force[:, 0], axis=1)

    @property
    def present(self) -> np.ndarray:
        return np.isfinite(self.magnitude)


@dataclass
class Frame:
    """The water's surface and every body's sources after one tick."""
    tick: int
    time: float  # s
    height: np.ndarray  # [j, i], m above the calm level
    bodies: dict  # index of the body: (position of the origin, total force, structured array of the sources)


@dataclass
class Replayed:
    info: ReplayInfo
    time: np.ndarray  # at the end of each tick, s
    bodies: list[BodySeries]
    maps: list[tuple[MapInfo, dict]]
    water: Optional[WaterDef]
    frames: list[Frame] = field(default_factory=list)
    differences: int = 0  # ticks that differ from the recording
    first_difference: str = ""

    @property
    def ticks(self) -> int:
        return len(self.time)

    @property
    def dt(self) -> np.ndarray:
        """Of each tick, s."""
        return np.diff(self.time, prepend=0.0)

    def peak(self) -> Optional[tuple[BodySeries, int]]:
        """The body and the row of the largest total force; None without a body."""
        best = None
        for body in self.bodies:
            if body.present.any():
                row = int(np.nanargmax(body.magnitude))
                if best is None or body.magnitude[row] > best[0].magnitude[best[1]]:
                    best = body, row
        return best


def collect(path: str, frames: int = 12) -> Replayed:
    """Replays the recording and reads what the report shows. frm.Error if it cannot be read."""
    with Context() as context:
        replayed = _series(context, path)
        if replayed.water is not None and replayed.ticks:
            replayed.frames = _frames(context, path, replayed, frames)
    return replayed


def _series(context: Context, path: str) -> Replayed:
    with Replay(context, path) as replay, Progress("replaying", replay.info().ticks) as progress:
        info = replay.info()
        rows = int(info.ticks)
        world = replay.world()
        time = np.full(rows, np.nan)
        bodies = [BodySeries(index, *(np.full((rows, *shape), np.nan, np.float32) for shape in
                                      ((len(PARTS), 3), (len(PARTS), 3), (len(STATES),))),
                             np.full((rows, 3), np.nan), np.full(rows, np.nan, np.float32))
                  for index in range(info.bodies)]
        replayed = Replayed(info, time, bodies, [], None)
        handles: dict[int, Body] = {}
        row = 0
        for result in replay:
            time[row] = world.stats().time
            for body in bodies:
                _read_body(replay, handles, body, row)
            if result.diverged and not replayed.differences:
                replayed.first_difference = f"tick {result.tick}, in {_what_differs(result)}"
            replayed.differences += bool(result.diverged)
            if replayed.water is None and info.has_water:
                replayed.water = _optional(lambda: replay.water().definition())
            row += 1
            progress(row)
        # A torn recording may end before the count that it announces.
        replayed.time = time[:row]
        for body in bodies:
            for name in ("force", "torque", "state", "position", "speed"):
                setattr(body, name, getattr(body, name)[:row])
        replayed.maps = [(m.info(), _provenance(m.provenance())) for m in map(replay.map, range(info.maps))]
    return replayed


def _what_differs(result: ReplayStepResult) -> str:
    if result.part == Part.PART_WORLD:
        return "the world's hash"
    return f"the {Part(result.part).name.removeprefix('PART_').lower()} of body {result.body}"


def _optional(read):
    """What `read` gives; None if it is not there now."""
    try:
        return read()
    except Error as error:
        if error.status in (Status.ERROR_STATE, Status.ERROR_HANDLE):
            return None
        raise


def _read_body(replay: Replay, handles: dict, body: BodySeries, row: int) -> None:
    # Bodies come and go in a recording; the handle is asked for again only when there is none.
    handle = handles.get(body.index) or _optional(lambda: replay.body(body.index))
    forces = handle and _optional(handle.forces)
    if not forces:
        handles.pop(body.index, None)
        return
    handles[body.index] = handle
    for part, name in enumerate(PARTS):
        wrench = getattr(forces, name)
        body.force[row, part] = tuple(wrench.force)
        body.torque[row, part] = tuple(wrench.torque)
    state = handle.state()
    body.state[row] = [getattr(state, name) for name in STATES]
    body.position[row] = tuple(state.pose.position)
    body.speed[row] = np.linalg.norm(tuple(state.twist.linear))


def _provenance(text: str) -> dict:
    try:
        parsed = json.loads(text)
    except ValueError:
        return {"provenance": text}
    return parsed if isinstance(parsed, dict) else {"provenance": parsed}


def _chosen_rows(replayed: Replayed, count: int) -> list[int]:
    """Evenly spread in time up to the last tick; the one nearest to the largest force becomes it."""
    count = max(1, min(count, replayed.ticks))
    times = replayed.time[-1] * np.arange(1, count + 1) / count
    rows = np.minimum(np.searchsorted(replayed.time, times - 1e-9), replayed.ticks - 1)
    if peak := replayed.peak():
        rows[np.argmin(np.abs(rows - peak[1]))] = peak[1]
    return sorted(set(rows.tolist()))


def _frames(context: Context, path: str, replayed: Replayed, count: int) -> list[Frame]:
    wanted = _chosen_rows(replayed, count)
    frames = []
    with Replay(context, path) as replay, Progress("reading frames", wanted[-1] + 1) as progress:
        for row in range(wanted[-1] + 1):
            replay.step()
            if row in wanted:
                frames += _frame(replay, replayed, row)
            progress(row + 1)
    return frames


def _frame(replay: Replay, replayed: Replayed, row: int) -> list[Frame]:
    water = _optional(replay.water)
    if water is None:
        return []
    bodies = {}
    for series in replayed.bodies:
        if body := _optional(lambda: replay.body(series.index)):
            bodies[series.index] = (np.array(tuple(body.state().pose.position)),
                                    np.array(tuple(body.forces().total.force)), body.sources().copy())
    return [Frame(row + 1, float(replayed.time[row]), np.array(water.read().height), bodies)]
