"""The report as HTML: sections, tables, and sentences that say in numbers what each figure shows."""
from __future__ import annotations

import shlex
from html import escape
from pathlib import Path

import numpy as np

from . import _figures
from ._abi import MapInfo
from ._base import version
from ._html import document, facts as _facts, figure as _figure, many, table as _table
from ._progress import Progress
from ._replayed import PARTS, STATES, BodySeries, Replayed
from ._words import number, plural, quantity, vector

_SHOWN_BODIES = 6
# Of frm_map_info: a label and a unit for every field; one that is new shows its own name.
_MAP_FIELDS = {
    "format_version": ("format version", ""), "file_bytes": ("size of the file", "bytes"),
    "content_hash": ("content hash", ""), "sources": ("haptic sources", ""),
    "directions": ("directions of the stream, means", ""), "samples": ("samples of one period", ""),
    "triangles": ("sample triangles", ""), "period": ("period", "s"), "base_speed": ("base speed u₀", "m/s"),
    "density": ("density of the fluid baked", "kg/m³"),
               "viscosity": ("kinematic viscosity of the fluid baked", "m²/s"),
    "reynolds": ("Reynolds number baked", ""), "reynolds_solved": ("Reynolds number solved", ""),
    "reference_length": ("reference length", "m"), "quantisation_error": ("largest quantisation error", "%"),
    "area": ("area of the surface", "m²"), "volume": ("volume", "m³"),
               "centroid": ("centroid of the volume", "m"),
    "bounds_low": ("bounding box, low", "m"), "bounds_high": ("bounding box, high", "m"),
    "fluctuation_directions": ("directions of the stream, fluctuations", ""), "speeds": ("speeds of the means", ""),
    "has_spin": ("spin table", ""), "has_added_mass": ("added mass", ""),
    "direction_error_rms": ("error in held-out directions, rms", "%"),
    "direction_error_worst": ("error in held-out directions, worst", "%"),
    "uncertainty": ("uncertainty of the mean drag, worst direction", "%"),
}


def page(replayed: Replayed, recording: Path, run: dict) -> str:
    """The whole page."""
    scene = str(run.get("scene") or recording.stem)
    sections = [_head(replayed, recording, run, scene)]
    if replayed.frames:
        scale = _figures.FrameScale(replayed)
        sections.insert(1, _hero(replayed, scale))
    sections += [_body(replayed, body) for body in replayed.bodies[:_SHOWN_BODIES] if body.present.any()]
    if len(replayed.bodies) > _SHOWN_BODIES:
        sections.append(f"<p>The recording holds {plural(len(replayed.bodies), 'body')}; "
                        f"the first {_SHOWN_BODIES} are shown.</p>")
    if replayed.frames:
        sections.append(_water(replayed, scale))
    sections += [_map(index, info, provenance, len(replayed.maps))
                 for index, (info, provenance) in enumerate(replayed.maps)]
    if run.get("tick_us"):
        sections.append(_tick_times(run))
    return document(scene, sections,
                    f"Made by frm.report, frm {'.'.join(map(str, version()))}, from "
                    f"<code>{escape(recording.name)}</code>. Vectors are in frm's own frame: right-handed, z up.")


def _verdict(replayed: Replayed) -> str:
    if not replayed.differences:
        return f'<p class="verdict same">replayed {plural(replayed.ticks, "tick")}: identical</p>'
    return (f'<p class="verdict differs">replayed {plural(replayed.ticks, "tick")}: '
            f'{plural(replayed.differences, "tick")} differ{"s" if replayed.differences == 1 else ""}; first '
            f"{escape(replayed.first_difference)}</p>")


def _step(replayed: Replayed) -> str:
    dt = replayed.dt * 1e3
    if not replayed.ticks:
        return "–"
    if np.ptp(dt) < 1e-4 * dt.max():
        return quantity(float(f"{np.median(dt):.6g}"), "ms")
    return f"{number(dt.min())} to {number(dt.max())} ms"


def _head(replayed: Replayed, recording: Path, run: dict, scene: str) -> str:
    duration = float(replayed.time[-1]) if replayed.ticks else 0.0
    facts = [("Simulated time", quantity(duration, "s")), ("Ticks", number(replayed.ticks)),
             ("Step dt", _step(replayed)), ("Bodies", number(len(replayed.bodies)))]
    if water := replayed.water:
        facts.append(("Water cells", f"{water.nx} × {water.ny}"))
    if replayed.info.devices:
        facts.append(("Devices", number(replayed.info.devices)))
    if "tick_seconds" in run:
        facts.append(("Time in ticks", quantity(float(run["tick_seconds"]), "s")))
    notes = []
    if replayed.info.torn:
        notes.append("The recording was cut off; all up to there is shown.")
    if "ticks" in run and int(run["ticks"]) != replayed.ticks:
        notes.append(f"The run's summary counts {plural(int(run['ticks']), 'tick')}, "
                     f"the recording {number(replayed.ticks)}: they may not belong together.")
    command = run.get("command")
    if isinstance(command, list):
        command = shlex.join(map(str, command))
    ran = f" The recording came from <code>{escape(command)}</code>." if command else ""
    water_text = ""
    if water:
        water_text = (f" The water is {number(water.nx * water.cell)} m × {number(water.ny * water.cell)} m, "
                      f"{number(water.depth)} m deep, in cells of {number(water.cell * 1e3)} mm.")
    return f"""<header>
<p class="over">Force of water on moving objects</p>
<h1>{escape(scene)}</h1>
{_verdict(replayed)}
{_facts(facts)}
<p>The recording <code>{escape(recording.name)}</code> was replayed and every force compared with the recorded
one, bit for bit.{water_text}{ran}</p>
{''.join(f'<p class="note">{note}</p>' for note in notes)}
</header>"""


def _hero(replayed: Replayed, scale) -> str:
    peak = replayed.peak()
    shown = replayed.frames[-1]
    if peak:
        shown = min(replayed.frames, key=lambda frame: abs(frame.tick - 1 - peak[1]))
    uri, exaggeration = _figures.oblique(scale, shown)
    higher = f"Heights are drawn {number(exaggeration)} times as high as they are. "
    if np.abs(shown.height).max() > _figures.CUT * scale.limit:
        higher += f"What is beyond ±{quantity(_figures.CUT * scale.limit * 1e3, 'mm')} is cut off. "
    at = "at the time of the largest force, " if peak and shown.tick - 1 == peak[1] else ""
    arrow = "The arrow is the total force on the body. " if shown.bodies and scale.total > 0 else ""
    return _figure(uri, f"The water surface in space at {shown.time:.3f} s",
                   f"The water {at}{number(shown.time)} s: from {number(shown.height.min() * 1e3)} mm to "
                   f"{number(shown.height.max() * 1e3)} mm about calm. <small>{higher}{arrow}</small>")


def _impulse(replayed: Replayed, vectors: np.ndarray) -> np.ndarray:
    return np.nansum(vectors * replayed.dt[:, None], axis=0)


def _body(replayed: Replayed, body: BodySeries) -> str:
    name = f"Body {body.index}" if len(replayed.bodies) > 1 else "The body"
    row = int(np.nanargmax(body.magnitude))
    torque = np.linalg.norm(body.torque[:, 0], axis=1)
    turn = int(np.nanargmax(torque))
    force_text = (f"The force peaks at <b>{quantity(body.magnitude[row], 'N')}</b> after "
                  f"{quantity(replayed.time[row], 's')}, as {vector(body.force[row, 0], 'N')}; its impulse "
                  f"over the run is {vector(_impulse(replayed, body.force[:, 0]), 'N s')}. The torque peaks "
                  f"at {quantity(torque[turn], 'N m')} after {quantity(replayed.time[turn], 's')}. "
                  "<small>World frame; the total of all parts.</small>")
    figures = [_figure(_figures.forces(replayed, body),
                       f"{name}: force in N and torque in N m over time in s", force_text),
               _figure(_figures.parts(replayed, body),
                       f"{name}: buoyancy, pressure, friction and gravity in N over time",
                       _parts_text(replayed, body)),
               _figure(_figures.motion(replayed, body), f"{name}: height, speed and wet area over time",
                       _motion_text(replayed, body))]
    here = int(body.present.sum())
    stay = ""
    if here < replayed.ticks:
        stay = f"<p>It was there for {number(here)} of {plural(replayed.ticks, 'tick')}.</p>"
    heading = "Force and torque" if len(replayed.bodies) == 1 else f"Body {body.index}: force and torque"
    return (f"<section><h2>{heading}</h2>{stay}{figures[0]}<h3>Where the force comes from</h3>{figures[1]}"
            f"<h3>How deep and how fast</h3>{figures[2]}</section>")


def _parts_text(replayed: Replayed, body: BodySeries) -> str:
    sizes = np.linalg.norm(body.force, axis=2)
    peaks = {name: float(np.nanmax(sizes[:, part])) for part, name in enumerate(PARTS)}
    listed = ", ".join(f"{name} {quantity(peaks[name], 'N')}" for name in PARTS[1:])
    text = f"Largest in size: {listed}."
    mean = {name: float(np.nansum(sizes[:, part] * replayed.dt)) for part, name in enumerate(PARTS)}
    if mean["pressure"] > 0:
        share = 100 * mean["friction"] / mean["pressure"]
        text += f" Over the run, friction is {number(share)} % of pressure."
    return text + " <small>Each part has a scale of its own; the total is their sum.</small>"


def _motion_text(replayed: Replayed, body: BodySeries) -> str:
    state = dict(zip(STATES, body.state.T))
    wet = np.nan_to_num(state["wet_area"]) > 0
    if not wet.any():
        return "The body did not touch the water."
    row = int(np.nanargmax(state["wet_area"]))
    share = np.sum(replayed.dt[wet]) / replayed.time[-1]
    text = (f"The body was wet for {number(100 * share)} % of the time, most after "
            f"{quantity(replayed.time[row], 's')}: {quantity(state['wet_area'][row], 'm²')}, displacing at "
            f"most {quantity(1e3 * np.nanmax(state['displaced_volume']), 'l')}. It met the water at up to "
            f"{quantity(np.nanmax(state['relative_speed']), 'm/s')}, a Reynolds number of "
            f"{number(np.nanmax(state['reynolds']))}")
    if len(replayed.maps) == 1:
        text += f"; the map was solved at {number(replayed.maps[0][0].reynolds_solved)}"
    return text + "."


def _water(replayed: Replayed, scale) -> str:
    heights = [(frame.height.max(), frame.height.min(), frame.time) for frame in replayed.frames]
    crest, trough = max(heights), min(heights, key=lambda item: item[1])
    pictures = []
    with Progress("drawing frames", len(replayed.frames)) as progress:
        for frame in replayed.frames:
            total = sum((force for _, force, _ in frame.bodies.values()), np.zeros(3))
            forces = f" · force {vector(total, 'N')}" if frame.bodies else ""
            pictures.append(f'<figure><img src="{_figures.frame(scale, frame)}" '
                            f'alt="Water height from above after {frame.time:.3f} s">'
                            f"<figcaption>tick {number(frame.tick)}{forces}</figcaption></figure>")
            progress(len(pictures))
    legend = ""
    if any(frame.bodies for frame in replayed.frames):
        legend = (" Dots are the haptic sources, filled where they are wet; thin arrows show the resistance "
                  "on each, on a scale of their own, and the thick arrow the total force, all seen from "
                  "above: what points up or down is in the numbers.")
    part = " The pictures show the part of the field around the bodies." if scale.clipped else ""
    return f"""<section><h2>Water surface</h2>
<p>The highest crest is <b>{quantity(crest[0] * 1e3, 'mm')}</b> after {quantity(crest[2], 's')}, the deepest
trough <b>{quantity(trough[1] * 1e3, 'mm')}</b> after {quantity(trough[2], 's')}, among the
{plural(len(heights), 'time')} shown. The colours are the same in all pictures and end at
±{quantity(scale.limit * 1e3, 'mm')}.{legend}{part}</p>
<figure class="key"><div class="wide"><img src="{_figures.colour_bar(scale)}"
alt="Colours of the water height in mm"></div></figure>
<div class="frames">{''.join(pictures)}</div></section>"""


def _map(index: int, info: MapInfo, provenance: dict, count: int) -> str:
    rows = []
    for name in info.field_names():
        label, unit = _MAP_FIELDS.get(name, (name, ""))
        value = getattr(info, name)
        if name == "content_hash":
            text = f"{value:016x}"
        elif name == "quantisation_error":
            text = f"{number(100 * value)} % of the peak force"
        elif name in ("direction_error_rms", "direction_error_worst", "uncertainty"):
            text = f"{number(100 * value)} % of the peak force" if value > 0 else "not known"
        elif name.startswith("has_"):
            text = "yes" if value else "no"
        elif isinstance(value, (int, float)):
            text = quantity(value, unit)
        else:
            text = vector(value, unit)
        rows.append((label, text))
    solved = info.reynolds_solved / info.reynolds if info.reynolds else 1.0
    caption = (f"{plural(info.sources, 'source')} on {quantity(info.area, 'm²')} of surface, known in "
               f"{plural(info.directions, 'direction')} at {quantity(info.base_speed, 'm/s')}; the series "
               f"repeat every {quantity(info.period, 's')} of map time.")
    if solved < 0.999:
        caption += (f" The solver's grid carried a Reynolds number of {number(info.reynolds_solved)}, "
                    f"{number(100 * solved)} % of the one asked for.")
    flows = provenance.get("directions")
    flows = flows if isinstance(flows, list) and flows and all(isinstance(one, dict) for one in flows) else None
    made = _flat({key: value for key, value in provenance.items() if key != "directions" or not flows})
    made = _table(made) if made else "<p>The map does not say how it was made.</p>"
    return (f"<section><h2>{'The map' if count == 1 else f'Map {index}'}</h2><p>{caption}</p>"
            f'<div class="two"><div><h3>What it holds</h3>{_table(rows)}</div>'
            f"<div><h3>How it was made</h3>{made}</div></div>{_flows(flows) if flows else ''}</section>")


def _flows(flows: list[dict]) -> str:
    """The flow solved for each direction: a row each, a column for every value of the first."""
    columns = list(flows[0])
    rows = [[_cell(one.get(name)) for name in columns] for one in flows]
    return f"<h3>The flow from each direction</h3>{many([name.replace('_', ' ') for name in columns], rows)}"


def _cell(value) -> str:
    if isinstance(value, list):
        return "(" + ", ".join(_plain(item) for item in value) + ")"
    return number(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else _plain(value)


def _flat(value, name: str = "") -> list[tuple[str, str]]:
    """Nested JSON as rows: names joined by dots, short lists in one row."""
    if isinstance(value, dict):
        return [row for key, item in value.items()
                for row in _flat(item, f"{name}.{key}" if name else str(key))]
    if isinstance(value, list) and any(isinstance(item, (dict, list)) for item in value):
        return [row for at, item in enumerate(value) for row in _flat(item, f"{name}[{at}]")]
    if isinstance(value, list):
        text = ", ".join(map(_plain, value[:40])) + (f", … ({len(value)} in all)" if len(value) > 40 else "")
    else:
        text = _plain(value)
    return [(name.replace("_", " "), text)]


def _plain(value) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "–"}[value]
    return number(value, 4) if isinstance(value, float) else str(value)


def _tick_times(run: dict) -> str:
    tick_us = run["tick_us"]
    budget = _figures.BUDGET_US
    edges, counts = tick_us["histogram"]["edges_us"], tick_us["histogram"]["counts"]
    over = sum(count for edge, count in zip(edges, counts) if edge >= budget)
    if tick_us["max"] <= budget:
        verdict = (f"the slowest, {quantity(tick_us['max'], 'µs')}, takes "
                   f"{number(100 * tick_us['max'] / budget)} % of the {number(budget)} µs that a tick at "
                   "500 Hz may take")
    else:
        verdict = (f"the slowest takes {quantity(tick_us['max'], 'µs')}; {plural(over, 'tick')} or more went "
                   f"over the {number(budget)} µs of a tick at 500 Hz")
    us = {key: quantity(tick_us[key], "µs") for key in ("median", "p99", "p9999", "mean")}
    text = (f"Half of the {plural(sum(counts), 'tick')} took less than <b>{us['median']}</b>, 99 % less than "
            f"{us['p99']}, 99.99 % less than {us['p9999']}; {verdict}. "
            f"<small>Mean {us['mean']}. Both axes are logarithmic.</small>")
    return (f"<section><h2>Time of a tick</h2>"
            f"{_figure(_figures.tick_times(tick_us), 'Histogram of tick times in µs', text)}</section>")
