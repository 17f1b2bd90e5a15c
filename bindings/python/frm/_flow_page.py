"""The page of a flow: sections, tables, and sentences that say in numbers what each figure shows."""
from __future__ import annotations

import math
from html import escape
from pathlib import Path

import numpy as np

from . import _flow_figures
from ._base import version
from ._flow import Flow, knows_grid
from ._html import document, facts, figure, many, table
from ._words import number, plural, quantity, vector

_FEW_PERIODS = 10  # of shedding in the record, below which its mean and frequency are poorly known
_ENDINGS = {
    "confidence": "The run ended by itself when the confidence asked for was reached.",
    "seconds": "The run ended when the time given by --seconds was over.",
    "cancelled": "The run was interrupted; this is what was known by then.",
}


def page(flow: Flow) -> str:
    """The whole page."""
    sections = [_head(flow), _uncertainty(flow), _better(flow), _series(flow)]
    if flow.slices:
        sections.append(_slices(flow))
    sections += [_grid(flow), _case(flow)]
    return document(f"{Path(flow.report['mesh']).stem}, flow", sections,
                    f"Made by frm.flow_report, frm {'.'.join(map(str, version()))}.")


def _percent(share: float) -> str:
    return f"{number(100 * share, 2)} %"


def _periods(flow: Flow) -> float:
    """Of shedding, in the record."""
    if not flow.json["strouhal"]:
        return 0.0
    frequency = flow.json["strouhal"] * flow.report["fastest"] / flow.json["length"]
    return frequency * flow.json["interval"] * len(flow.time)


def _answer(flow: Flow) -> str:
    json, off = flow.json, flow.json["uncertainty"]
    name, value = (("torque", json["torque_coefficient"]) if flow.spin_alone else ("drag", json["cd"]))
    least, most = sorted((value * (1 - off), value * (1 + off)))
    known = f" ({number(least, 4)} to {number(most, 4)})" if knows_grid(json) else ", or more: the grid's part is not measured,"
    text = (f"The {name} coefficient is <b>{number(value, 4)} ± {_percent(off)}</b>{known} at a Reynolds "
            f"number of {number(json['reynolds'])}")
    if json["strouhal"]:
        text += f"; the wake sheds at a Strouhal number of <b>{number(json['strouhal'])}</b>"
        if _periods(flow) < _FEW_PERIODS:
            text += f", which {number(_periods(flow), 2)} periods tell poorly"
    return text + "."


def _head(flow: Flow) -> str:
    json, report = flow.json, flow.report
    values = [("Drag coefficient", number(json["cd"], 4))] if not flow.spin_alone else []
    if json.get("torque_coefficient") is not None:
        values.append(("Torque coefficient", number(json["torque_coefficient"])))
    at_least = "" if knows_grid(json) else "at least "
    values.append(("Uncertainty", at_least + _percent(json["uncertainty"])))
    if json["strouhal"]:
        values.append(("Strouhal number", number(json["strouhal"])))
    values += [("Reynolds number", number(json["reynolds"])), ("Cells", number(float(f"{json['cells']:.3g}"))),
               ("Memory", f"{number(json['bytes'] / 2 ** 20)} MiB"), ("Time", quantity(json["seconds"], "s"))]
    notes = [note[:1].upper() + note[1:] for note in report.get("notes", [])]
    if json["ending"] in _ENDINGS:
        notes.append(_ENDINGS[json["ending"]])
    force = vector(json["force_mean"], "N a metre" if report.get("section") else "N")
    return f"""<header>
<p class="over">Force of water on rigid objects</p>
<h1>{escape(Path(report['mesh']).name)}</h1>
<p>{_answer(flow)}</p>
{facts(values)}
<p>The mean force is {force} in the mesh's frame.</p>
{''.join(f'<p class="note">{escape(note)}</p>' for note in notes)}
</header>"""


def _uncertainty(flow: Flow) -> str:
    json, parts = flow.json, flow.json["uncertainty_parts"]
    statistics = (f"from how the running mean over {quantity(flow.time[-1] + json['interval'], 's')} still moves")
    grid = "not measured: the run on half the resolution was left out"
    if json.get("half_resolution"):
        grid = "not measured: these are the cells of the run on half the resolution"
    if parts["grid"] is not None:
        grid = "from a run on half the resolution"
        if json.get("cd_coarse") is not None:
            grid += (f", whose drag coefficient is {number(json['cd_coarse'], 4)} where this one's is "
                     f"{number(json['cd'], 4)}")
    meanings = {"grid": grid, "statistics": statistics,
                "blockage": f"from the far field: the body fills {_percent(json['blockage'])} of its cross section"}
    rows = [(name.capitalize(), f"{'–' if parts[name] is None else _percent(parts[name])}, {meaning}")
            for name, meaning in meanings.items()]
    rows.append(("Total", f"{_percent(json['uncertainty'])}, the root of the squares of those that are known"))
    what = "torque" if flow.spin_alone else "drag"
    drawn = figure(_flow_figures.uncertainty({name: parts[name] for name in meanings}, json["uncertainty"]),
                   f"Parts of the uncertainty of the mean {what} in per cent",
                   f"What is not known of the mean {what}: one standard error each, or its like.")
    return f"<section><h2>How sure it is</h2>{drawn}{table(rows)}</section>"


def _advice(flow: Flow) -> list[str]:
    """What to change, the most useful first."""
    json, report = flow.json, flow.report
    parts = {name: value or 0.0 for name, value in json["uncertainty_parts"].items()}
    flat = report.get("section") and not report.get("slab")
    resolution, duration = report["resolution"], report["duration"]
    finer = (f"Cells half as large, <code>--resolution {2 * resolution:g}</code>, take about "
             f"{8 if flat else 16} times as long")
    advice = []
    largest = max(parts, key=parts.get)
    if largest == "grid":
        advice.append(f"The grid is the largest part, {_percent(parts['grid'])}. {finer}.")
    elif largest == "statistics":
        goal, longer = 100 * parts["statistics"] / 2, 4 * max(report.get("travelled", duration), 0.5)
        advice.append(f"The mean over time is the largest part, {_percent(parts['statistics'])}. It falls with the "
                      "root of the time: half of it takes a record four times as long, "
                      f"<code>--duration {longer:.3g} --confidence {goal:.2g}</code>.")
    else:
        advice.append(f"The far field is the largest part, {_percent(parts['blockage'])}; it is the solver's own, and "
                      "no option makes it smaller.")
    if not knows_grid(json):
        advice.append("The error of the grid is not known, so the total says too little: " + (
            f"the run ended before the one on all cells had recorded, and all of this is of {resolution / 2:g} cells. "
            "Give it more time." if json.get("half_resolution") else
            "take 8 cells or more, <code>--resolution 8</code>." if resolution < 8 else
            "leave out <code>--no-grid-error</code>."))
    if json["reynolds_solved"] < 0.999 * json["reynolds"]:
        advice.append(f"The cells carry a Reynolds number of {number(json['reynolds_solved'])}, not the "
                      f"{number(json['reynolds'])} asked for. {finer}.")
    periods = _periods(flow)
    if 0 < periods < _FEW_PERIODS:
        needed = math.ceil(_FEW_PERIODS / periods * max(report.get("travelled", duration), 0.5))
        advice.append(f"The series holds {number(periods, 2)} periods of the shedding; {_FEW_PERIODS} and more tell "
                      f"its frequency well: <code>--duration {needed}</code>.")
    return advice


def _better(flow: Flow) -> str:
    rows = "".join(f"<li>{text}</li>" for text in _advice(flow))
    return f"<section><h2>What would make it better</h2><ul>{rows}</ul></section>"


def _series(flow: Flow) -> str:
    json, curves = flow.json, flow.coefficients
    name = "torque" if flow.spin_alone else "drag"
    values = curves[name]
    unit = "N m" if flow.spin_alone else ""
    text = (f"The {name} is {quantity(values.mean(), unit)} in the mean, from {quantity(values.min(), unit)} to "
            f"{quantity(values.max(), unit)}")
    if "lift" in curves:
        axis = vector(flow.report["lift_axis"])
        text += (f"; the lift is shown along {axis} of the mesh, where it swings most, with an amplitude of "
                 f"{number(json['cl_amplitude'])}")
    drawn = figure(_flow_figures.series(flow), "Coefficients of the force over lengths travelled",
                   f"{text}. <small>The series begins after the start-up.</small>")
    if "lift" in curves and len(values) >= 16:
        if json["strouhal"]:
            said = (f"The lift swings at a Strouhal number of <b>{number(json['strouhal'], 4)}</b>, every "
                    f"{quantity(json['length'] / (json['strouhal'] * flow.report['fastest']), 's')}; the series holds "
                    f"{number(_periods(flow))} such periods.")
        else:
            said = "No frequency stands out."
        drawn += "<h3>Spectrum of the lift</h3>" + figure(
            _flow_figures.spectrum(flow), "Spectrum of the lift coefficient over the Strouhal number", said)
    return f"<section><h2>Force over time</h2>{drawn}</section>"


def _slices(flow: Flow) -> str:
    drawn = []
    for one in flow.slices:
        pressures = one.pressure[np.isfinite(one.pressure)]
        across = vector(flow.report["axes"][one.other])
        text = (f"The plane through the body's middle along x, the stream, and {'xyz'[one.other]}, which is {across} "
                f"of the mesh. The pressure coefficient goes from {number(float(pressures.min()))} to "
                f"{number(float(pressures.max()))}. <small>Means over the last third of the run.</small>")
        drawn.append(figure(_flow_figures.slices(flow, one), "Speed and pressure about the body", text))
    return f"<section><h2>The flow</h2>{''.join(drawn)}</section>"


def _grid(flow: Flow) -> str:
    blocks = flow.json["blocks"]
    origin = "in the stream's frame about the mesh's origin"
    drawn = ""
    if flow.slices:
        drawn = figure(_flow_figures.grid(flow, flow.slices[0]), "The boxes of the grid",
                       f"The boxes over the speed, {origin}. Each is twice as fine as what surrounds it.")
        if len({block["cell"] for block in blocks}) == 1:
            drawn = figure(_flow_figures.grid(flow, flow.slices[0]), "The grid", f"The grid over the speed, {origin}.")
    rows = [(number(1e3 * block["cell"]), number(block["cells"]),
             *(f"{number(block['low'][k])} to {number(block['high'][k])}" for k in range(3))) for block in blocks]
    total = sum(block["cells"] for block in blocks)
    return (f"<section><h2>The grid</h2><p>{plural(len(blocks), 'block')} with {number(total)} cells in "
            f"{quantity(flow.json['bytes'] / 2 ** 20, 'MiB')}; the finest cell is "
            f"{quantity(1e3 * min(block['cell'] for block in blocks), 'mm')}.</p>{drawn}"
            f"{many(('cell, mm', 'cells', 'x, m', 'y, m', 'z, m'), rows)}</section>")


def _case(flow: Flow) -> str:
    report, json = flow.report, flow.json
    asked = [("Mesh", str(report["mesh"])), ("Direction of the stream", vector(report["direction"])),
             ("Speed", quantity(report["speed"], "m/s"))]
    if any(report["spin"]):
        asked.append(("Spin", vector(report["spin"], "rad/s")))
    if report.get("section"):
        asked.append(("Section across", vector(report["section_normal"])))
        if report.get("slab"):
            asked.append(("Span solved", f"{number(report['slab'])} reference lengths"))
    asked += [("Density", quantity(report["density"], "kg/m³")),
              ("Kinematic viscosity", quantity(report["viscosity"], "m²/s")),
              ("Resolution", f"{number(report['resolution'])} cells a reference length"),
              ("Start-up", f"{number(report['start_up'])} lengths"),
              ("Duration at most", f"{number(report['duration'])} lengths")]
    if report.get("confidence"):
        asked.append(("Confidence asked for", _percent(report["confidence"])))
    solved = [("Reference length of the solver", quantity(report["reference_length"], "m")),
              ("Length of the Reynolds and Strouhal numbers", quantity(json["length"], "m")),
              ("Area across the stream", quantity(json["area"], "m² a metre" if report.get("section") else "m²")),
              ("Reynolds number solved", number(json["reynolds_solved"])),
              ("Samples", f"{number(json['samples'])}, every {quantity(json['interval'], 's')}"),
              ("Recorded", f"{number(report['travelled'])} lengths"),
              ("Steps", number(json["steps"])),
              ("Cell updates a second", f"{number(json['mlups'])} million")]
    for name, axis in zip("xyz", report["axes"]):
        solved.append((f"{name} of the stream's frame", f"{vector(axis)} of the mesh"))
    return (f'<section><h2>The case</h2><div class="two"><div><h3>What was asked for</h3>{table(asked)}</div>'
            f"<div><h3>What was solved</h3>{table(solved)}</div></div></section>")
