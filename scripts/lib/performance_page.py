"""docs/performance.md and its plots, from what `frm bench frontier` printed."""
from __future__ import annotations

import datetime
import io
import math

from flow_page import Table

TITLES = {"waves": "Waves alone", "buoyancy": "Buoyancy alone", "maps": "Maps of several qualities, and MuJoCo", "tow": "A body under water",
          "crowd": "A thousand bodies", "stroke": "The paddle's stroke through waves", "boat": "A hull in waves"}
PLOTTED = ("waves", "buoyancy", "maps", "tow", "crowd", "stroke", "boat")
PLAYED = ("stroke", "boat", "tow", "crowd")
# A knob has its colour in every plot.
COLOURS = {"triangles": "C0", "sources": "C1", "directions": "C2", "map precision": "C3", "cell": "C4", "order": "C5", "tick": "C6",
           "skip": "C7", "error budget": "C8", "time budget": "C9", "preset": "black", "points counted": "C3", "points smoothed": "C1",
           "map": "C2", "MuJoCo": "C3", "cell, order 2": "C4", "cell, order 4": "C5", "together": "0.4"}
SCATTERED = ("together", "skip")  # settings without an order: no line joins them
LABEL_AT = {"accurate": (8, -14)}
CAPTIONS = {
    "waves": "Waves against d'Alembert's exact solution. The exact answer is that of the equations, not of the sea: real waves have "
             "dispersion ([model.md](model.md#limits)).",
    "buoyancy": "Left: against the closed form for an ellipsoid cut by a plane. Right: against 32,768 triangles in the same waves, since "
                "nothing exact is known there. Times are of buoyancy alone. *Points counted* is the paper's way and that of many games: "
                "each of N points that is under water lifts by its share of the volume; *smoothed*, by the part of its cell that is. Points lift "
                "straight up: in waves they lack the sideways force of a sloping surface, so that more of them do not help. The clip's error is the "
                "shape's (chords of an ellipsoid); it also gives what is wet of each region, which resistance needs and points do not know.",
    "tow": "Directions and precision of the map cost no time, only its size. What a tick costs here is its sources; the error budget gives a "
           "bound that is kept, so that what it buys is more than it must, and a budget below the bound of any group costs a little and buys "
           "nothing.",
    "crowd": "A time budget is one for all bodies together; an error budget is each body's.",
    "stroke": "No knob by itself gets far: triangles, sources, cells and ticks each have a like part in the error.",
    "boat": "Most of the time goes into the displaced volume. Cells of 50, 25 and 12.5 mm, the finest among them, lay it on coarse grids "
            "that coincide, and err alike by them: that they agree within a tenth of a per cent says nothing of that part. Other cells differ "
            "from them by 0.3 to 0.9 % whatever their size, which is what that part may be ([model.md](model.md#limits)).",
    "maps": "The plate of 8 x 1 x 30 cm from bakes at a draft's resolution with 6 to 102 directions (before symmetry), against that of "
            "102. MuJoCo's box is an ellipsoid of the same half axes to its fluid model, with its usual coefficients. It is compared with a "
            "baked map, not with a measurement: how far the maps are off direct runs is in [validation-map.md](validation-map.md). The smallest time "
            "budget takes the whole body as one, as MuJoCo does.",
}


def percent(share):
    if share is None:
        return "–"
    return "0" if share == 0 else f"{100 * share:.3g} %"


def microseconds(us):
    return f"{us:.3g} us" if us < 1000 else f"{us / 1000:.3g} ms"


def error(row, of, kind=None, measure="rms"):
    """Against what is exact, else the finest of all, else the finest of the knob; None if there is none."""
    for one in (kind,) if kind else ("exact", "finest", "knob_finest"):
        if of in row["error"].get(one, {}):
            return row["error"][one][of][measure]
    return None


def factor(value):
    return f"x {value:.2f}" if value < 10 else f"x {value:.0f}"


class Scene:
    def __init__(self, record):
        self.table = record["result"]["scenes"][0]
        self.of, self.rows = self.table["error_of"], self.table["rows"]

    def knobs(self):
        """Rows by knob, in the bench's order."""
        out = {}
        for row in self.rows:
            out.setdefault(row["knob"], []).append(row)
        return out

    def default(self):
        return next((row for row in self.rows if row["default"]), None)

    def error(self, row, kind=None, measure="rms"):
        return error(row, self.of, kind, measure)


def rows_table(scene):
    """Every setting."""
    torque = scene.of == "force"
    heads = ["knob", "setting", ">time", ">of the default's", f">{'error' if not torque else 'force'}", ">worst"]
    heads += [">torque"] if torque else []
    heads += [">by this knob alone"] if any("knob_finest" in row["error"] for row in scene.rows) else []
    table = Table(*heads)
    for row in scene.rows:
        low, high = row["ratio_quartiles"]
        label = f"**{row['label']}**" if row["default"] else row["label"]
        if "map_bytes" in row and row["knob"] in ("sources", "directions", "map precision", "triangles", "map"):
            label += f" ({row['map_bytes'] / 1000:.0f} kB)"
        cells = [row["knob"], label + (" *" if row["frontier"] else ""), microseconds(row["us_at_500_hz"]),
                 f"{row['ratio']:.2f} ({low:.2f} to {high:.2f})", percent(scene.error(row)), percent(scene.error(row, measure="worst"))]
        if torque:
            cells.append(percent(error(row, "torque")))
        if len(heads) > len(cells):
            cells.append(percent(scene.error(row, "knob_finest")))
        table.row(*cells)
    return table.lines


def steps(scene):
    """(knob, default, coarser, finer) for knobs whose settings have an order."""
    for knob, rows in scene.knobs().items():
        at = next((i for i, row in enumerate(rows) if row["default"]), None)
        if at is None or knob in ("skip", "error budget", "time budget", "together", "preset", "tick") or rows[0]["peer"]:
            continue
        yield knob, rows[at], rows[at - 1] if at > 0 else None, rows[at + 1] if at + 1 < len(rows) else None


def verdict(time_coarser, error_coarser, time_finer, error_finer):
    """Where a step of the knob changes neither by a twentieth, it does not matter; where time by error falls by less than a tenth,
    it does not pay."""
    def flat(*factors):
        return all(f is None or 0.95 <= f <= 1.05 for f in factors)
    if flat(time_coarser, error_coarser, time_finer, error_finer):
        return "no matter"
    if time_coarser is not None and time_coarser < 0.95 and error_coarser * time_coarser < 0.9:
        return "coarser pays"
    if error_finer is not None and error_finer < 0.95 and error_finer * time_finer < 0.9:
        return "finer pays"
    return "yes"


def knee_lines(scenes):
    table = Table("scene", "knob", "default", "coarser", ">time", ">error", "finer", ">time", ">error", "at the knee")
    counts = {}
    for name, scene in scenes.items():
        for knob, default, coarser, finer in steps(scene):
            base = scene.error(default)
            if not base:
                continue
            def change(row):
                return (row["ratio"] / default["ratio"], scene.error(row) / base) if row else (None, None)
            (tc, ec), (tf, ef) = change(coarser), change(finer)
            said = verdict(tc, ec, tf, ef)
            counts[said] = counts.get(said, 0) + 1
            table.row(name, knob, default["label"], coarser["label"] if coarser else "–", factor(tc) if coarser else "–",
                      factor(ec) if coarser else "–", finer["label"] if finer else "–", factor(tf) if finer else "–",
                      factor(ef) if finer else "–", said)
    return table.lines, counts


def summary_lines(scenes):
    table = Table("scene", "preset", ">time", ">of the default's", ">force, rms", ">worst", ">torque, rms", "on the frontier")
    for name in PLAYED:
        if name not in scenes:
            continue
        scene = scenes[name]
        presets = scene.knobs().get("preset") or [scene.default()]
        for row in presets:
            table.row(name, row["label"] if row["knob"] == "preset" else "default", microseconds(row["us_at_500_hz"]), f"{row['ratio']:.2f}",
                      percent(scene.error(row)), percent(scene.error(row, measure="worst")), percent(error(row, "torque")),
                      "yes" if row["frontier"] else "no")
    return table.lines


def draw_scene(axes, scene, title=None):
    for knob, rows in scene.knobs().items():
        points = [(row["us_at_500_hz"], 100 * scene.error(row)) for row in rows if scene.error(row)]
        if not points:
            continue
        colour = COLOURS.get(knob)
        if knob == "preset":
            axes.plot(*zip(*points), "*", color="black", markersize=12, zorder=5, linestyle="", label="presets")
            for (x, y), row in zip(points, rows):
                axes.annotate(row["label"], (x, y), textcoords="offset points", xytext=LABEL_AT.get(row["label"], (8, 8)), weight="bold",
                              zorder=6)
        elif rows[0]["peer"]:
            axes.plot(*zip(*points), "x--" if len(points) > 1 else "X", color=colour, markersize=7 if len(points) > 1 else 10, label=knob)
        else:
            axes.plot(*zip(*points), linestyle="" if knob in SCATTERED else "-", marker="D" if knob in SCATTERED else "o", markersize=4, linewidth=1, color=colour, label=knob)
    best = sorted((row["us_at_500_hz"], 100 * scene.error(row)) for row in scene.rows if row["frontier"] and scene.error(row))
    if len(best) > 1:
        axes.plot(*zip(*best), drawstyle="steps-post", color="0.75", linewidth=5, zorder=0, label="nothing beats these")
    default = scene.default()
    if default and "preset" not in scene.knobs() and scene.error(default):
        axes.plot(default["us_at_500_hz"], 100 * scene.error(default), "*", color="black", markersize=12, zorder=5, label="the default")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.grid(True, which="major", color="0.9")
    against = "the exact answer" if "exact" in scene.rows[0]["error"] else "the finest" if scene.table["reference"] else "the last"
    what = "heights, rms, % of their rms" if scene.of == "height" else "force, rms, % of its peak"
    axes.set_ylabel(f"error of the {what},\nagainst {against}")
    if title:
        axes.set_title(title, fontsize=9)


def plot(scenes, titles):
    def draw(form):
        import matplotlib
        matplotlib.use("Agg")
        matplotlib.rcParams.update({"svg.hashsalt": "frm", "svg.fonttype": "none", "font.size": 9})
        from matplotlib import pyplot
        from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

        figure, all_axes = pyplot.subplots(1, len(scenes), figsize=(8.5, 4.6), layout="constrained", squeeze=False)
        for axes, scene, title in zip(all_axes[0], scenes, titles):
            draw_scene(axes, scene, title)
            plain = FuncFormatter(lambda v, _: f"{v:g}")
            for axis in (axes.xaxis, axes.yaxis):
                low, high = axis.get_view_interval()
                axis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < 300 * low else (1,)))
                axis.set_major_formatter(plain)
                axis.set_minor_formatter(NullFormatter())
            axes.set_xlabel("time, us, for 2 ms of the scene (a tick at 500 Hz)" if len(scenes) == 1 and scene.table["scene"] != "buoyancy"
                            else "time of one evaluation, us")
        handles, labels = all_axes[0][0].get_legend_handles_labels()
        all_axes[0][-1].legend(handles, labels, loc="upper left", bbox_to_anchor=(1.02, 1), borderaxespad=0, fontsize=8)
        content = io.BytesIO()
        if form == "svg":
            figure.savefig(content, format="svg", metadata={"Date": None})
        else:
            figure.savefig(content, format="png", dpi=110)
        pyplot.close(figure)
        if form != "svg":
            return content.getvalue()
        return ("\n".join(line.rstrip() for line in content.getvalue().decode().splitlines()) + "\n").encode()
    return draw


def origin(records):
    """Where and from what the numbers come; a page of several machines or commits says so."""
    def all_of(key):
        return ", ".join(sorted({str(record[key]) for record in records.values()}))
    loads = [record["load"] for record in records.values()]
    repeats = sorted({record["result"]["repeats"] for record in records.values()})
    total = sum(record["seconds"] for record in records.values())
    return (f"Written by `scripts/performance` ({datetime.date.today():%Y-%m-%d}, commit {all_of('commit')}, {all_of('machine')}; each setting "
            f"{'/'.join(map(str, repeats))} times; load of the machine when scenes ended {min(loads):.1f} to {max(loads):.1f}, "
            f"{total / 60:.0f} minutes in all).")


def introduction(records, quick):
    warning = ["", "**Written with `--quick`: small scenes and a few settings. The numbers are not for use.**"] if quick else []
    return ["# Run time against error", "", origin(records), *warning, "",
            "What each setting costs and what it buys, by `frm bench frontier`. One scene:", "",
            "    frm bench frontier --scene stroke", "",
            "## How to read it", "",
            "- **Time** is that of 2 ms of the scene on one core, which is a tick at 500 Hz; where the tick is shorter or longer, as many as "
            "fit. Each tick is played several times, all settings of a knob taking turns of 0.2 s of the scene, so that what else the machine does meets "
            "all of them alike; what counts is the mean over the ticks of each tick's median. *Of the default's* is the ratio in the same repeat, "
            "median and quartiles; the microseconds of a scene are that ratio times the default's.",
            "- **Error** is the rms over the motion (*worst*: the largest) of the difference of the total force or torque, as a share of the "
            "reference's peak. The reference is the exact answer in the scenes that have one, and else **the finest**: all knobs at "
            "their finest together, which each scene names. *By this knob alone* compares with the finest of the same knob and all else as by "
            "default: what the knob itself does, where another hides it.",
            "- A `*` marks the settings that no other beats in both: the frontier. **Bold** is the default.",
            "- The bodies of these scenes have maps from a law that is known for each triangle (`cli/frontier_maps.h`), so that any number "
            "of sources or directions is of the same object. How good baked maps are is another matter: [validation-map.md](validation-map.md). "
            "Nothing here is compared with real water."]


def geometric(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def preset_factors(scenes):
    """{preset: (time, force, torque)} over the default's, means over the scenes that have presets."""
    out = {}
    for name in ("fast", "accurate"):
        pairs = []
        for scene in scenes.values():
            rows = {row["label"]: row for row in scene.knobs().get("preset", [])}
            if name in rows and "default" in rows:
                pairs.append((rows[name], rows["default"]))
        if pairs:
            out[name] = (geometric([row["ratio"] for row, _ in pairs]),
                         *(geometric([error(row, of) / error(default, of) for row, default in pairs]) for of in ("force", "torque")))
    return out


def preset_section(scenes):
    lines, counts = knee_lines({name: scenes[name] for name in (*PLAYED, "waves") if name in scenes})
    summed = ", ".join(f"{count} {name}" for name, count in sorted(counts.items(), key=lambda item: (-item[1], item[0])))
    factors = [f"**{name}** takes {time:.2f} of the default's time and has {force:.2f} of its force error and {torque:.2f} of its torque error "
               f"(time by error: {time * force:.2f} and {time * torque:.2f})" for name, (time, force, torque) in preset_factors(scenes).items()]
    knee = [f"Over these scenes (geometric means) {'; '.join(factors)}. A product below 1 says that the step away from the default buys more than "
            "it costs, one above that it does not. Where `fast` is below 1 it is a good choice for who is short of time: what keeps the default "
            "finer is the torque, the waves (below), and that its errors stay a small part of a baked map's own "
            "([validation-map.md](validation-map.md))."] if factors else []
    return ["## The presets", "",
            "A preset is a name for three settings; everything else stays at its default. `\"preset\": \"fast\"` in a scene or "
            "`frm run --preset fast` takes the cells and the order; the map is baked beforehand.", "",
            "| preset | bake | cells | order |", "| --- | --- | --- | --- |",
            "| fast | `--quality draft` | twice the scene's | 2 |",
            "| **default** | `--quality standard` | the scene's | the scene's (2) |",
            "| accurate | `--quality high` | the scene's | 4 |", "",
            *summary_lines(scenes), "", *knee, "",
            "### The default, knob by knob", "",
            "A default is at the knee where the step coarser loses more in error than it gains in time, and the step finer costs more in time "
            "than it gains in error. Factors are against the default; error is that of the whole scene, so that a knob is only worth refining "
            "where it is the one that limits. A step *pays* where time by error falls by a tenth or more; *no matter*: neither changes by a "
            "twentieth. How long a tick is the host says; its costs and errors are below.", "",
            *lines, "", f"Of these: {summed}.", "",
            "**Waves.** Second order is the default because it is cheaper and a body's force hardly shows the difference. Who looks at waves "
            "that run for many of their lengths is better off with fourth order and cells a third larger, for the same time: see the next section."]


def page(records, quick):
    """(Markdown, {name of a plot: how to draw it as "svg" or "png"})"""
    scenes = {name: Scene(record) for name, record in records.items()}
    parts, plots = [introduction(records, quick), preset_section(scenes)], {}
    for name in PLOTTED:
        if name not in scenes:
            continue
        shown = [name] + (["buoyancy-waves"] if name == "buoyancy" and "buoyancy-waves" in scenes else [])
        file = f"performance-{name}"
        plots[file] = plot([scenes[one] for one in shown], ("calm water", "in waves") if len(shown) > 1 else (None,))
        lines = [f"## {TITLES[name]}", ""]
        for one in shown:
            table = scenes[one].table
            lines.append(f"{table['what'][0].upper()}{table['what'][1:]}.")
            if table["reference"] and name != "maps":
                lines.append(f"The finest: {table['reference']}.")
            if table["peak_force"]:
                lines.append(f"Peak force {table['peak_force']:.3g} N, torque {table['peak_torque']:.3g} N m.")
        if name in CAPTIONS:
            lines += ["", CAPTIONS[name]]
        lines += ["", f"![Time against error]({file}.svg)"]
        for one in shown:
            lines += ["", *([f"### {'In calm water' if one == name else 'In waves'}", ""] if len(shown) > 1 else []), *rows_table(scenes[one])]
        parts.append(lines)
    return "\n\n".join("\n".join(part) for part in parts) + "\n", plots
