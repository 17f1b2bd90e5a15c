"""docs/validation-flow.md and its picture, from what the cases gave."""
from __future__ import annotations

import io
import math

from flow_cases import BODIES, CASES, CHECKED, REFERENCES, SERIES
from flow_judge import convergence, measured, number, rows, stated, turned

NAMES = {"cd": "drag", "cl": "mean side force", "cl_amplitude": "lift amplitude", "strouhal": "Strouhal number",
         "torque_coefficient": "torque", "seconds": "seconds"}

WIDEST = 25  # per cent that the picture shows


def percent(share, sign=False):
    return "–" if share is None else f"{100 * share:{'+' if sign else ''}.1f} %"


def value_of(value):
    return "–" if value is None else f"{value:.4g}"


def yes(flag):
    return "–" if flag is None else "yes" if flag else "**no**"


def count(value):
    value = number(value)
    return "–" if value is None else f"{value / 1e6:.2f} M" if value >= 1e5 else f"{value:.0f}"


def megabytes(value):
    value = number(value)
    return "–" if value is None else f"{value / 1e6:.0f} MB"


def thousands(value):
    return f"{value:,.0f}" if value >= 1 else f"{value:g}"


def minutes(seconds):
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"


def cell(text):
    """Text that stays in one cell of a table."""
    return " ".join(str(text).replace("|", "\\|").split())


class Table:
    """A Markdown table; numbers to the right."""

    def __init__(self, *heads):
        self.lines = ["| " + " | ".join(head.lstrip(">") for head in heads) + " |",
                      "| " + " | ".join("---:" if head.startswith(">") else "---" for head in heads) + " |"]

    def row(self, *cells):
        self.lines.append("| " + " | ".join(map(cell, cells)) + " |")


def missing(record):
    """What stands where a result would, or nothing."""
    return "not measured" if record is None else "**failed**" if "error" in record else ""


def results_section(records):
    table = Table("case", ">Re", "", ">measured", ">reference", "its band", ">off", ">must be within", "reached",
                  ">stated uncertainty", ">grid", ">statistics", ">blockage", "honest")
    for case in CASES:
        if not case.targets:
            continue
        record = records.get(case.name)
        for row in rows(case, record):
            target, known, own = row.target, row.known, row.uncertainty
            allowed = f"{target.at_most:g}" if target.at_most else f"{target.percent:g} %"
            if target.aim:
                allowed += f", aim {target.aim:g} %"
            table.row(case.name, thousands(case.reynolds), NAMES[target.quantity],
                      missing(record) or value_of(row.value), known.value if known else "",
                      f"{known.low:g} to {known.high:g}" if known else "", percent(row.off, True) if known else "",
                      allowed, yes(row.reached), percent(own.total), percent(own.grid), percent(own.statistics),
                      percent(own.blockage), yes(row.honest))
    return ["## Against the literature", "", *table.lines, "",
            "Stated uncertainty: what the program itself says of the mean drag (of the torque), one standard error, "
            "and the three parts it is made of. Honest: the reference is no farther away than twice the stated "
            "uncertainty and half the width of the reference's band, as a root of squares; nothing is stated of the other "
            "quantities. Torque and side force are compared without their sign. Re of a spin is w a^2 / nu, its "
            "coefficient T / (rho/2 w^2 a^5). Seconds: the program's own or those on the clock, whichever are more."]


def turned_section(records):
    table = Table("case", "against", ">drag", ">turned", ">change", ">statistics of the change", ">must be within",
                  "reached")
    for case in CASES:
        if not case.like:
            continue
        t = turned(case, records.get(case.name), records.get(case.like))
        table.row(case.name, case.like, value_of(t.plain), value_of(t.turned), percent(t.change, True),
                  percent(t.statistics), f"{case.percent:g} %", yes(t.reached))
    return ["## The body turned on the lattice", "",
            "The same flow with the lattice turned about the stream: what changes is the lattice's doing, or chance "
            "(one standard error of the change, from the two runs' own statistics).", "", *table.lines]


def convergence_section(records):
    lines = ["## Convergence", "",
             "Fitted by least squares: drag = limit + c / cells^order. The stated grid error is honest where it is no "
             "less than half of what the run is off the limit."]
    by_name = {case.name: case for case in CASES}
    for title, names in SERIES.items():
        known = [(by_name[name], records[name]) for name in names
                 if name in records and measured(records[name], "cd") is not None]
        without = [name for name in names if name not in [case.name for case, _ in known]]
        values = [measured(record, "cd") for _, record in known]
        errors = [(stated(record).statistics or 0) * value for (_, record), value in zip(known, values)]
        fit = convergence([case.resolution for case, _ in known], values, errors)
        table = Table(">cells across", ">drag", ">off the limit", ">stated grid error", "honest", ">cells", ">time")
        for (case, record), value in zip(known, values):
            off = None if fit.limit is None else value / fit.limit - 1
            grid = stated(record).grid
            honest = None if off is None or grid is None else abs(off) <= 2 * grid
            table.row(f"{case.resolution:g}", value_of(value), percent(off, True), percent(grid), yes(honest),
                      count(record["result"].get("cells")), minutes(record["wall_seconds"]))
        said = fit.remark
        if fit.order is not None:
            said = f"Order {fit.order:.2f}, limit {fit.limit:.4g}, residual {percent(fit.residual)} of it"
            said += f"; {fit.remark}" if fit.remark else ""
        elif fit.limit is not None:
            said += f" ({fit.limit:.4g})"
        lines += ["", f"### {title[0].upper()}{title[1:]}", "", *table.lines, "", said[0].upper() + said[1:] + "."]
        if without:
            lines += ["", "Without " + ", ".join(without) + "."]
    return lines


def kernel_section(bench):
    if not bench:
        return []
    table = Table("`frm bench`", ">", "")
    for result in bench:
        value = number(result.get("value"))
        table.row(f"`{result['name']}`", "–" if value is None else f"{value:.4g}", result.get("unit", ""))
    return ["## Kernel", "", *table.lines, ""]


def cost_section(records):
    table = Table("case", ">cells", ">memory", ">steps", ">million updates a second", ">time", "ended by", "note")
    for case in CASES:
        record = records.get(case.name)
        result = (record or {}).get("result") or {}
        speed = number(result.get("mlups"))
        table.row(case.name, count(result.get("cells")), megabytes(result.get("bytes")), count(result.get("steps")),
                  "–" if speed is None else f"{speed:.0f}", minutes(record["wall_seconds"]) if record else "–",
                  missing(record) or result.get("ending", "–"),
                  "; ".join([case.note] * bool(case.note) + (record or {}).get("notes", [])))
    return ["## What each case took", "", *table.lines]


def failed_section(records):
    lines = [f"- `{case.name}`: {cell(records[case.name]['error'])}" for case in CASES
             if "error" in records.get(case.name, {})]
    return ["## Failed", "", *lines, ""] if lines else []


def commands_section():
    return ["## Commands", "",
            "In `out/validation-flow`, where `scripts/validate-flow` puts the meshes; `--list` names the cases, "
            "`--only` runs some of them.", "", "```sh",
            *(f"frm {' '.join(case.command())}  # {case.name}" for case in CASES), "```"]


def sources_section():
    table = Table("", ">Re", "", ">value", ">low", ">high", "checked", "source")
    for (body, reynolds, quantity), known in REFERENCES.items():
        table.row(BODIES[body].title, thousands(reynolds), NAMES[quantity], known.value, known.low, known.high,
                  known.checked, known.source)
    return ["## References", "", "; ".join(f"*{word}*: {what}" for word, what in CHECKED.items()) + ".", "",
            *table.lines]


def page(records, bench, picture):
    done = [record for record in records.values() if "result" in record]
    all_rows = [row for case in CASES for row in rows(case, records.get(case.name))]
    all_turned = [turned(case, records.get(case.name), records.get(case.like)) for case in CASES if case.like]
    needed = [row.reached for row in all_rows] + [t.reached for t in all_turned]
    judged = [row.honest for row in all_rows if row.honest is not None]
    took = sum(record["wall_seconds"] for record in records.values())

    def each(key):
        return ", ".join(sorted({record[key] for record in records.values()})) or "–"
    days = sorted(record["started"][:10] for record in records.values()) or ["–"]
    head = Table("", "")
    head.row("date", days[0] if days[0] == days[-1] else f"{days[0]} to {days[-1]}")
    head.row("machine", each("machine"))
    head.row("commit (+: with changes)", each("commit"))
    head.row("solver (hash of its sources)", each("solver"))
    head.row("time, all cases", minutes(took))
    head.row("cases", f"{len(done)} of {len(CASES)} gave a result")
    head.row("must be reached", f"{sum(needed)} of {len(needed)} reached")
    head.row("stated uncertainty", f"honest in {sum(judged)} of {len(judged)}")
    sections = [
        ["# The flow solver against what is known", "",
         "Made by `scripts/validate-flow`, which runs the cases and writes this page; not edited by hand. The solver "
         "is described in [flow.md](flow.md).", "", *head.lines, "", f"![Deviation of each mean]({picture})"],
        failed_section(records), results_section(records), turned_section(records), convergence_section(records),
        kernel_section(bench), cost_section(records), commands_section(), sources_section()]
    return "\n\n".join("\n".join(section).rstrip("\n") for section in sections if section) + "\n"


def picture(records):
    """How far each mean is off, with the program's own uncertainty (twice the standard error), as SVG."""
    import matplotlib
    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.hashsalt": "frm", "svg.fonttype": "none", "font.size": 9})
    from matplotlib import pyplot

    shown = [row for case in CASES for row in rows(case, records.get(case.name)) if row.known]
    figure, axes = pyplot.subplots(figsize=(8, 0.6 + 0.27 * len(shown)), layout="constrained")
    for at, row in enumerate(shown):
        low, high = (100 * (side / row.known.value - 1) for side in (row.known.low, row.known.high))
        axes.barh(at, high - low, left=low, height=0.7, color="#d8dde3")
        axes.vlines([-row.target.percent, row.target.percent], at - 0.35, at + 0.35, color="#8a6d00", linewidth=1)
        if row.off is None:
            word = missing(records.get(row.case.name)).strip("*") or "not reported"
            axes.text(0, at, word, ha="center", va="center", color="#b00020")
            continue
        off = 100 * row.off
        if abs(off) > WIDEST:
            axes.text(math.copysign(0.98 * WIDEST, off), at, f"{off:+.0f} %", ha="right" if off > 0 else "left",
                      va="center", color="#b00020")
            continue
        error = 200 * (row.uncertainty.total or 0) * abs(row.value / row.known.value)
        axes.errorbar(off, at, xerr=error or None, fmt="o", markersize=4, capsize=2,
                      color="#0b6e4f" if row.reached else "#b00020")
    axes.set_yticks(range(len(shown)), [f"{row.case.name}, {NAMES[row.target.quantity]}" for row in shown])
    axes.set_ylim(len(shown) - 0.4, -0.6)
    axes.axvline(0, color="black", linewidth=0.6)
    axes.set_xlim(-WIDEST, WIDEST)
    axes.set_xlabel("off the reference, %\nbars: twice the stated uncertainty; grey: the reference's band; "
                    "brown: what must be reached")
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    pyplot.close(figure)
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines()) + "\n"
