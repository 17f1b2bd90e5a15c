"""The page of a bake: sections, tables, and sentences that say in numbers what each figure shows."""
from __future__ import annotations

from html import escape
from pathlib import Path

import numpy as np

from . import _bake_figures
from ._bake import Bake
from ._base import version
from ._flow import knows_grid
from ._html import document, facts, figure, many, table
from ._words import number, plural, quantity, vector

MOST_FLOWS = 40  # shown one by one
_FEW_PERIODS = 10  # of shedding in a record, below which its mean and frequency are poorly known
_IN_STEP = 0.5  # correlation below which two neighbours are said to be out of step


def page(bake: Bake) -> str:
    """The whole page."""
    sections = [_head(bake), _verdicts(bake), _body(bake), _directions(bake), _fluctuations(bake), _flows(bake),
                _strips(bake), _case(bake)]
    return document(f"{Path(bake.json['mesh']).stem}, bake", sections,
                    f"Made by frm.bake_report, frm {'.'.join(map(str, version()))}.")


def _percent(share, digits: int = 2) -> str:
    return "–" if share is None else f"{number(100 * share, digits)} %"


def _time(seconds: float) -> str:
    if seconds < 120:
        return quantity(seconds, "s")
    return quantity(seconds / 60, "min") if seconds < 7200 else quantity(seconds / 3600, "h")


# ---- What is asked of a map, and whether it holds ------------------------------------------------------------

def _judged(bake: Bake):
    """(name, error, what was asked, what it is) of each error that a map states."""
    e, b = bake.errors, bake.budgets
    return [
        ("Between directions, rms", e["direction_rms"], b["direction_rms"],
         "mean force where a flow was left out and predicted from all others; share of the largest mean force"),
        ("Between directions, worst", e["direction_worst"], b["direction_worst"], "the same, the worst direction"),
        ("Rounding", e["rounding"], b["rounding"],
         "of the tables, worst mean and worst fluctuation; share of the largest force"),
        ("Regions", e["regions"], b["regions"],
         "one wet ratio, velocity and point of attack a region, for a half-immersed, turning body; share of the rms "
         "force and torque"),
        ("The flows' mean drag", e["uncertainty"], b["uncertainty"],
         "of the least certain flow at the base speed: its grid (half of the difference to half the resolution), its "
         "statistics and the far field; share of the largest mean force")]


def _verdict(error, budget) -> str:
    if error is None:
        return "not known"
    if budget is None:
        return "nothing was asked"
    return "within" if error <= budget else "not within"


def _missed(bake: Bake) -> list[str]:
    return [name for name, error, budget, _ in _judged(bake) if _verdict(error, budget) == "not within"]


def _notes(bake: Bake) -> list[str]:
    notes = [note[:1].upper() + note[1:] for note in bake.json["notes"]]
    slow = [flow for flow in bake.flows if flow["reynolds_solved"] < 0.999 * flow["reynolds"]]
    if slow:
        least = min(slow, key=lambda flow: flow["reynolds_solved"] / flow["reynolds"])
        notes.append(f"In {number(len(slow))} of {plural(len(bake.flows), 'flow')} the cells do not carry the Reynolds "
                     f"number: {number(least['reynolds_solved'])} was solved for {number(least['reynolds'])}. A finer "
                     "--resolution carries more.")
    errors, budgets = bake.errors, bake.budgets
    asked = budgets["direction_rms"] is not None and errors["direction_rms"] is not None
    if asked and (errors["direction_rms"] > budgets["direction_rms"]
                  or errors["direction_worst"] > budgets["direction_worst"]):
        notes.append(f"Directions are predicted from each other to {_percent(errors['direction_rms'])} rms and "
                     f"{_percent(errors['direction_worst'])} at worst, not the {_percent(budgets['direction_rms'])} "
                     f"and {_percent(budgets['direction_worst'])} of this quality: take a higher --quality, "
                     "--resolution or --directions.")
    if errors["uncertainty"] > budgets["uncertainty"]:
        notes.append(f"The mean drag of a direction is uncertain by {_percent(errors['uncertainty'])} of the largest "
                     "force: take a higher --quality or --resolution.")
    return notes


def _head(bake: Bake) -> str:
    o, m, e = bake.options, bake.map, bake.errors
    missed, notes = _missed(bake), _notes(bake)
    if missed:
        badge, look = f"Not within what was asked: {', '.join(missed).lower()}", "differs"
    elif e["direction_rms"] is None:
        badge, look = "One flow is all directions, by symmetry; the rest is within what was asked", "same"
    elif bake.budgets["direction_rms"] is None:
        badge, look = "Nothing was asked of its directions; the rest is within", "same"
    else:
        badge, look = f"Within all that {o['quality']} quality asks", "same"
    if notes and not missed:
        badge, look = badge + f"; {'a warning' if len(notes) == 1 else 'warnings'} below", "heeded"
    values = [("Quality", escape(o["quality"])), ("Flows", number(len(bake.flows))),
              ("Time of this run", _time(bake.json["seconds"])), ("File", f"{number(m['bytes'] / 1e3)} kB"),
              ("Largest mean force", quantity(bake.largest_force, "N")), ("Reynolds number", number(m["reynolds"]))]
    said = (f"In a stream of {quantity(o['speed'], 'm/s')} from a direction that was not solved, the map's mean force "
            f"is off by about <b>{_percent(e['direction_rms'])}</b> of the largest (at worst "
            f"{_percent(e['direction_worst'])}); the mean drag of the flows themselves is known to "
            f"<b>{_percent(e['uncertainty'])}</b> of the largest force or better{_without_grid(bake)}.")
    if e["direction_rms"] is None:
        said = (f"The body's symmetry makes every direction of the one that was solved, at {quantity(o['speed'], 'm/s')}. "
                f"Its mean drag is known to <b>{_percent(e['uncertainty'])}</b>{_without_grid(bake)}.")
    return f"""<header>
<p class="over">Force of water on rigid objects</p>
<h1>{escape(Path(bake.json['mesh']).name)}: the map</h1>
<p>{said}</p>
<p class="verdict {look}">{escape(badge)}</p>
{facts(values)}
{''.join(f'<p class="note">{escape(note)}</p>' for note in notes)}
</header>"""


def _without_grid(bake: Bake) -> str:
    unknown = sum(not knows_grid(flow) for flow in bake.base)
    if unknown == 0:
        return ""
    return ", not counting the grid" + ("" if unknown == len(bake.base) else f" of {plural(unknown, 'flow')}")


def _solving(bake: Bake) -> float:
    return sum(flow["seconds"] for flow in bake.flows)


def _verdicts(bake: Bake) -> str:
    e = bake.errors
    rows = [(name, _percent(error), _percent(budget), _verdict(error, budget))
            for name, error, budget, _ in _judged(bake)]
    said = table([(name, what) for name, _, _, what in _judged(bake)])
    parts = [("wet ratio alone", e["wet_ratio"]), ("velocity alone", e["velocity"]),
             ("point of attack alone", e["arm"])]
    rest = [("Regions, by parts", ", ".join(f"{name} {_percent(value)}" for name, value in parts)),
            ("Added mass, estimated", _percent(e["added_mass"]) + (
                " of the diagonal about the centroid (docs/added-mass.md)" if e["added_mass"] is not None else
                " (left out)"))]
    worst = max(bake.base, key=lambda flow: flow["uncertainty"] * _drag(bake, flow))
    rest.append(("Least certain flow", f"{_name(bake, worst)}: {_uncertainty(worst)} of its drag, "
                 f"{_percent(worst['uncertainty'] * _drag(bake, worst) / bake.largest_force)} of the largest force"))
    far = max(bake.base, key=lambda flow: flow["left_out"] or 0.0)
    if far["left_out"] is not None:
        rest.append(("Worst predicted flow", f"{_name(bake, far)}: off by {_percent(far['left_out'])}, "
                     f"{quantity(far['left_out'] * bake.largest_force, 'N')}"))
    return (f"<section><h2>Stated errors</h2>{many(('error', 'is', 'asked for', ''), rows)}"
            "<p>They are apart: those of directions and rounding are of the map against its flows, that of the regions "
            "of a tick against one with ever smaller regions, the last of the flows against the water.</p>"
            f"<h3>What each is of</h3>{said}<h3>Where they come from</h3>{table(rest)}</section>")


def _name(bake: Bake, flow: dict) -> str:
    if flow["kind"] == "spin":
        return f"spin about {vector(flow['direction'])}"
    speed = "" if flow["speed"] == bake.options["speed"] else f" at {quantity(flow['speed'], 'm/s')}"
    return f"towards {vector(flow['direction'])}{speed}"


def _drag(bake: Bake, flow: dict) -> float:
    """Of a stream's flow, N."""
    return 0.5 * bake.options["density"] * flow["speed"] ** 2 * flow["area"] * abs(flow["cd"])


def _in_all(flow: dict) -> str:
    return _percent(flow["uncertainty"]) + (" in all" if knows_grid(flow) else " or more")


def _uncertainty(flow: dict) -> str:
    names = {"statistics": "statistics", "grid": "grid", "blockage": "far field"}
    parts = flow["uncertainty_parts"].items()
    known = [f"{names[name]} {_percent(value)}" for name, value in parts if value is not None]
    return f"{_percent(flow['uncertainty'])} ({', '.join(known)})"


# ---- Body, directions, fluctuations --------------------------------------------------------------------------------

def _body(bake: Bake) -> str:
    body = bake.json["body"]
    extent = [high - low for low, high in zip(body["low"], body["high"])]
    drawn = figure(_bake_figures.body(bake), "The surface from three sides in the colours of its haptic regions",
                   f"{plural(body['sources'], 'haptic region')}, each in a colour, and their sources as dots. The "
                   "arrows are the mesh's axes.")
    sources = bake.surface("sources")[:, :3]
    rows = [("Extent along x, y, z", vector(extent, "m")), ("Surface, volume", f"{quantity(body['area'], 'm²')}, "
            f"{quantity(body['volume'], 'm³')}"), ("Sample triangles", number(body["triangles"])),
            ("Symmetry", body["symmetry"] if bake.options["symmetry"] else "not looked for (--no-symmetry)"),
            ("Patches that flows are recorded on", number(body["patches"]))]
    listed = ""
    if len(sources) <= 24:
        normals = bake.surface("sources")[:, 3:]
        listed = "<h3>Sources</h3>" + many(("source", "at x, y, z, m", "mean normal"), [
            (number(at), vector(place), vector(normal)) for at, (place, normal) in enumerate(zip(sources, normals))])
    return f"<section><h2>The body and its regions</h2>{drawn}{table(rows)}{listed}</section>"


def _directions(bake: Bake) -> str:
    images = sum(flow["images"]["shape"][0] for flow in bake.base)
    means = bake.array(bake.json["means"])
    most, least = int(bake.drag.argmax()), int(bake.drag.argmin())
    errors = np.array([flow["left_out"] for flow in bake.base if flow["left_out"] is not None])
    text = (f"Where the stream goes to, in the mesh's frame; equal areas of the sphere are equal areas here. "
            f"{plural(len(bake.base), 'direction')} {'was' if len(bake.base) == 1 else 'were'} solved at "
            f"{quantity(bake.options['speed'], 'm/s')}")
    if images > len(bake.base):
        text += f"; the body's symmetry makes the force known in {number(images)}"
    text += (f". The map has it in {number(bake.map['directions'])}. The drag goes from {quantity(bake.drag[least], 'N')} "
             f"towards {vector(means[least, :3])} to {quantity(bake.drag[most], 'N')} towards {vector(means[most, :3])}.")
    if len(errors):
        off = int((errors > 0.1).sum())
        text += (f" Left out and predicted from the others, {number(off)} of {plural(len(errors), 'flow')} "
                 f"{'is' if off == 1 else 'are'} off by more than 10 % of the largest force.")
    drawn = figure(_bake_figures.directions(bake), "Drag and errors over the sphere of directions", text)
    return f"<section><h2>Where the stream was solved</h2>{drawn}</section>"


def _fluctuations(bake: Bake) -> str:
    pairs, step = bake.neighbours
    known = step[np.isfinite(step)]
    text = (f"{plural(bake.map['fluctuation_directions'], 'direction')} with {number(bake.map['samples'])} samples of "
            f"a period of {quantity(bake.map['period'], 's')}. The force swings by {quantity(bake.rms.min(), 'N')} to "
            f"{quantity(bake.rms.max(), 'N')} (rms), at most "
            f"{_percent(bake.rms.max() / bake.largest_force)} of the largest mean force.")
    if len(known):
        text += (f" The correlation of neighbours is {number(float(known.mean()), 2)} in the mean; "
                 f"{number(int((known < _IN_STEP).sum()))} of {plural(len(known), 'pair')} "
                 f"{'is' if (known < _IN_STEP).sum() == 1 else 'are'} below {_IN_STEP}. A blend of two that are "
                 "out of step swings less than either; a tick gives that strength back. <small>In the lower "
                 "picture a dot is the larger the more the force swings there.</small>")
    return (f"<section><h2>Fluctuations</h2>"
            f"{figure(_bake_figures.fluctuations(bake), 'Strength and step of the fluctuations over the sphere', text)}"
            f"</section>")


# ---- The flows ----------------------------------------------------------------------------------------------------

def periods(flow: dict) -> float:
    """Of shedding, in the record."""
    if not flow["strouhal"]:
        return 0.0
    return flow["strouhal"] * flow["fastest"] / flow["length"] * flow["interval"] * flow["samples"]


def _flows(bake: Bake) -> str:
    columns = ["", "towards", "speed", "drag coeff.", "Strouhal", "uncertain", "grid", "statistics", "far field",
               "left out", "samples", "10⁶ cells", "time, s"]
    rows = []
    for at, flow in enumerate(bake.flows):
        parts, spin = flow["uncertainty_parts"], flow["kind"] == "spin"
        rows.append([number(at), ("spin about " if spin else "") + vector(flow["direction"]),
                     quantity(flow["speed"], "rad/s" if spin else "m/s"),
                     "–" if flow["cd"] is None else number(flow["cd"]),
                     number(flow["strouhal"]) if flow["strouhal"] else "–",
                     ("" if knows_grid(flow) else "≥ ") + _percent(flow["uncertainty"]),
                     _percent(parts["grid"]), _percent(parts["statistics"]), _percent(parts["blockage"]),
                     _percent(flow["left_out"]), number(flow["samples"]), number(flow["cells"] / 1e6),
                     number(flow["seconds"])])
    if len({row[2] for row in rows}) == 1:
        for row in [columns, *rows]:
            del row[2]
    few = [flow for flow in bake.flows if 0 < periods(flow) < _FEW_PERIODS]
    shed = [flow for flow in bake.flows if flow["strouhal"]]
    at_a_time = ", several at a time" if _solving(bake) > 1.2 * bake.json["seconds"] else ""
    text = (f"{plural(len(bake.flows), 'flow')} took {_time(_solving(bake))}{at_a_time}. Drag coefficients are on the "
            "area across the stream; Strouhal numbers on the reference length of "
            f"{quantity(bake.map['reference_length'], 'm')}, where a frequency stands out")
    if shed:
        text += f" ({number(len(shed))} of {number(len(bake.flows))})"
    text += (". “Left out” is the error of the mean force as the other flows of its speed predict it, a share of the "
             "largest.")
    if few:
        text += (f" In {plural(len(few), 'flow')} the record holds fewer than {_FEW_PERIODS} periods of the shedding: "
                 "mean and frequency are poorly known there.")
    return f"<section class='flows'><h2>The flows</h2><p>{text}</p>{many(columns, rows)}</section>"


def shown(bake: Bake) -> list[int]:
    """The flows that are shown one by one: all, or the spins, which are few, and those that are known worst."""
    if len(bake.flows) <= MOST_FLOWS:
        return list(range(len(bake.flows)))
    worst = sorted(range(len(bake.flows)),
                   key=lambda at: (bake.flows[at]["kind"] != "spin",
                                   -max(bake.flows[at]["left_out"] or 0.0, bake.flows[at]["uncertainty"])))
    return sorted(worst[:MOST_FLOWS])


def _strips(bake: Bake) -> str:
    which = shown(bake)
    text = ("The coefficients of the force along the stream and across it, where it swings most; the spectrum of the "
            "latter with its Strouhal number (St) if one stands out; the mean so far in the band of its standard "
            "error; the speed of the water, a mean over the last third of the run.")
    if len(which) < len(bake.flows):
        spins = ", and the spins" if any(flow["kind"] == "spin" for flow in bake.flows) else ""
        text += (f" {number(len(bake.flows) - len(which))} of {number(len(bake.flows))} flows are left out: these are "
                 f"the {number(len(which))} with the largest error or uncertainty{spins}.")
    drawn = [figure(_bake_figures.speed_key(), "Colours of the speed", "")]
    for at in which:
        flow = bake.flows[at]
        said = [f"<b>{at}</b> {escape(_name(bake, flow))}"]
        if flow["cd"] is not None:
            said.append(f"drag coefficient {number(flow['cd'])} ± {_in_all(flow)}")
        elif flow["torque_coefficient"] is not None:
            said.append(f"torque coefficient {number(flow['torque_coefficient'])} ± {_in_all(flow)}")
        if flow["strouhal"]:
            said.append(f"{number(periods(flow), 2)} periods of shedding")
        if flow["left_out"] is not None:
            said.append(f"left out, off by {_percent(flow['left_out'])}")
        drawn.append(figure(_bake_figures.flow(bake, flow), f"Flow {at}: series, spectrum, running mean, speed",
                            " · ".join(said)))
    return f'<section class="strips"><h2>Flow by flow</h2><p>{text}</p>{"".join(drawn)}</section>'


def _case(bake: Bake) -> str:
    o, m = bake.options, bake.map
    asked = [("Mesh", str(bake.json["mesh"])), ("Hash of the mesh", str(bake.json.get("mesh_hash", "–"))),
             ("Quality", o["quality"]), ("Scale", number(o["scale"])), ("Base speed", quantity(o["speed"], "m/s"))]
    if len(o["speeds"]) > 1:
        asked.append(("Speeds", ", ".join(number(speed) for speed in o["speeds"]) + " m/s"))
    asked += [("Spin", f"{quantity(m['spin_rate'], 'rad/s')} about three axes" if m["spin_rate"] else "no"),
              ("Density", quantity(o["density"], "kg/m³")), ("Kinematic viscosity", quantity(o["viscosity"], "m²/s")),
              ("Directions", number(o["directions"]) if o["directions"] else "by quality"),
              ("Sources", number(o["sources"]) if o["sources"] else "by their error"),
              ("Threshold of harmonics", number(o["threshold"]))]
    solved = [("Map", str(m["file"])), ("Reference length", quantity(m["reference_length"], "m")),
              ("Resolution", f"{number(o['resolution'])} cells a reference length"),
              ("Start-up", f"{number(o['start_up'])} lengths"),
              ("Period, and what is faded into it", f"{number(o['period'])} and {number(o['overlap'])} lengths"),
              ("Harmonics", number(o["harmonics"])), ("Reynolds number", number(m["reynolds"])),
              ("Reynolds number solved", number(m["reynolds_solved"])),
              ("Time of this run", _time(bake.json["seconds"]))]
    drawn = (f'<section><h2>The case</h2><div class="two"><div><h3>What was asked for</h3>{table(asked)}</div>'
             f"<div><h3>What was solved</h3>{table(solved)}</div></div>")
    if m.get("added_mass"):
        matrix = np.array(m["added_mass"]).reshape(6, 6)
        dust = 1e-6 * np.abs(np.diag(matrix)).max()
        rows = [(name, *(number(float(value)) if abs(value) > dust else "0" for value in row))
                for name, row in zip(("force x", "force y", "force z", "torque x", "torque y", "torque z"), matrix)]
        drawn += ("<h3>Added mass</h3><p>About the mesh's origin, in water of "
                  f"{quantity(o['density'], 'kg/m³')}: kg, kg m and kg m².</p>"
                  + many(("", "x", "y", "z", "turn x", "turn y", "turn z"), rows))
    return drawn + "</section>"
