"""The page docs/validation-map.md from what scripts/validate-map gathered. What was not run this time keeps the row that the
page has: a part takes minutes to an hour, and its steps lie on the machine that ran them."""
from __future__ import annotations

import datetime
import math

from map_cases import (ASKED_REYNOLDS, BAKES, BODIES, LEAST_SWING, LONG_PERIODS, LONG_RECORD, LONG_START, SPEED_PERCENT,
                       SPIN_AXES, SPIN_PERCENT)


FLUCTUATIONS = f"""## Fluctuations there

How strongly the force swings about its mean (rms over the map's period, without what is slower), of the map over that of the
same direct run. The run's strength is that of all its stretches of a period, its error what these scatter by
(scripts/lib/map_swing.py). A map's own flow is one such stretch: by chance it is off by what the last column but one says, so
that is how near to a run a single direction can be; the mean over directions says whether maps swing too strongly.
Directions in which the run swings by less than {100 * LEAST_SWING:.1f} % of the largest mean force are not in the ratios; the last column has
the map's strength there, of that force."""


def lines_under(page, heading):
    """The lines of the table under a heading of a page."""
    section = page.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    return [line for line in section.splitlines() if line.startswith("| ")]


def cells(line):
    return [cell.strip() for cell in line.strip("| ").split(" | ")]


def line(row):
    return "| " + " | ".join(str(cell) for cell in row) + " |"


def table(head, names, rows, anew, before):
    """A row for each of the names that has one: of those in `anew` only what is in `rows`, of the others what there was under
    the same head in the lines `before`."""
    merged = {cells(old)[0]: old for old in before[2:]} if before and cells(before[0]) == list(head) else {}
    merged = {name: old for name, old in merged.items() if name not in anew}
    merged.update((str(row[0]), line(row)) for row in rows)
    return "\n".join([line(head), line("---" for _ in head), *(merged[name] for name in names if name in merged)])


BAKE_NAMES = [bake.name for bake in BAKES]


def bake_table(head, bakes, rows, before):
    return table(head, BAKE_NAMES, rows, [made["bake"].name for made in bakes], before)


def percent(share, digits=1):
    return f"{100 * share:.{digits}f} %"


def seconds(value):
    return f"{value:.0f} s" if value < 120 else f"{value / 60:.0f} min"


def verdict(good):
    return "yes" if good else "**no**"


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def held_out(made):
    """(rms, worst) of the mean force as shares of the peak."""
    errors = [math.hypot(*minus(one["map"]["force_mean"], one["run"]["force_mean"])) / made["peak"] for one in made["held"]]
    return math.sqrt(sum(e * e for e in errors) / len(errors)), max(errors)


def bakes_table(bakes, before):
    rows = []
    for made in bakes:
        bake, result = made["bake"], made["made"]["result"]
        took, load, cores = made["made"]["seconds"], made["made"].get("load", 0), made["made"].get("cores", 1)
        busy = load > 1.5 * cores
        good = "not known" if busy and took > bake.longest else verdict(took <= bake.longest)
        rows.append((bake.name, BODIES[bake.body].title, len(made["info"]["provenance"]["directions"]), made["info"]["sources"],
                     seconds(took) + (f" (busy machine: load {load:.0f} on {cores} cores)" if busy else ""),
                     f"{seconds(bake.longest)}: {good}" if bake.longest else "–", made["made"]["version"][:8]))
    return bake_table(("map", "object", "flows", "sources", "time", "asked", "program"), bakes, rows, before)


def directions_table(bakes, before):
    rows = []
    for made in bakes:
        if not made["held"]:
            continue
        rms, worst = held_out(made)
        asked, info = made["bake"].asked, made["info"]
        rows.append((made["bake"].name, percent(rms), percent(worst),
                     f"{percent(asked[0], 0)}, {percent(asked[1], 0)}: {verdict(rms <= asked[0] and worst <= asked[1])}" if asked else "–",
                     percent(info["direction_error_rms"]), percent(info["direction_error_worst"]),
                     percent(sum(one["run"]["uncertainty"] for one in made["held"]) / len(made["held"]))))
    return bake_table(("map", "rms", "worst", "asked", "stated rms", "stated worst", "runs' own uncertainty"), bakes, rows, before)


def fluctuations_table(bakes, before):
    rows = []
    for made in bakes:
        least = LEAST_SWING * made["peak"]
        swings = [(math.hypot(*one["map"]["force_rms"]), *one["swing"]) for one in made["held"] if one["swing"]]
        strong = [swing for swing in swings if swing[1] >= least]
        weak = [swing[0] / made["peak"] for swing in swings if swing[1] < least]
        row = [made["bake"].name, "–", "–", "–", "–", "–", percent(max(weak), 1) if weak else "–"]
        if strong:
            logs = [math.log(max(felt, 1e-3 * run) / run) for felt, run, _, _ in strong]
            mean = sum(logs) / len(logs)
            error = math.sqrt(sum((l - mean)**2 for l in logs) / max(1, len(logs) - 1) / len(logs))
            own = math.sqrt(sum(u * u for _, _, u, _ in strong) / len(strong))
            of_one = math.sqrt(sum(u * u * n for _, _, u, n in strong) / len(strong))
            row[1:6] = [f"{math.exp(mean):.2f} (-{percent(1 - math.exp(-error), 0)}, +{percent(math.exp(error) - 1, 0)})" if len(logs) > 1 else f"{math.exp(mean):.2f}",
                        f"{math.exp(min(logs)):.2f} to {math.exp(max(logs)):.2f}",
                        f"{sum(abs(math.exp(l) - 1) <= 0.1 for l in logs)} of {len(logs)}", percent(own, 0),
                        percent(of_one, 0)]
        if strong or weak:
            rows.append(row)
    return bake_table(("map", "strength, map over run (geometric mean, its error)", "range", "within 10 %", "the run's own error",
                  "that of one period", "map at most where runs swing less"), bakes, rows, before)


def sizes_table(bakes, before):
    rows = []
    for made in bakes:
        size, limit = made["made"]["result"]["file_bytes"] / 1e3, made["bake"].kilobytes
        stated = made["info"]["quantisation_error"]
        found = made["verified"]["quantisation_error"]
        rows.append((made["bake"].name, f"{size:.0f} kB", f"{limit:.0f} kB: {verdict(size <= limit and stated < 0.01)}" if limit else "–",
                     percent(stated, 2), percent(found, 2), f"{made['raw_bytes'] / 1e3:.0f} kB"))
    return bake_table(("map", "file", "asked", "stated error", "found against the raw tables", "raw tables, fp32 by zstd"), bakes, rows, before)


def speeds_table(rows, before):
    out = []
    for row in rows:
        several, one = row["several"] / row["run"] - 1, row["one"] / row["run"] - 1
        out.append((f"{row['reynolds']:,}", percent(several), percent(one), verdict(abs(several) <= SPEED_PERCENT / 100)))
    names = [f"{reynolds:,}" for reynolds in ASKED_REYNOLDS]
    return table(("Reynolds number", "map of five speeds", "map of one (Re 1,000)", f"within {SPEED_PERCENT} %"), names, out,
                 names if rows else [], before)


def spin_table(rows, before):
    out = []
    for row in rows:
        if not {"with", "without", "run"} <= row.keys():
            continue
        off = row["with"] / row["run"] - 1
        out.append((row["axis"], f"{row['run']:.3g} N m", percent(off), percent(row["without"] / row["run"] - 1),
                    percent(row["uncertainty"]), verdict(abs(off) <= SPIN_PERCENT / 100)))
    return table(("axis", "direct run", "map with spins", "paper's rule", "run's own uncertainty", f"within {SPIN_PERCENT} %"),
                 list(SPIN_AXES), out, list(SPIN_AXES) if rows else [], before)


def held_out_in_words(made):
    rms, worst = held_out(made)
    return f"{made['bake'].name}: held out {percent(rms)} rms, {percent(worst)} at worst; {seconds(made['made']['seconds'])}"


def page(bakes, speeds, spin, commit, machine, versions, before):
    held = directions_table(bakes, lines_under(before, "Directions held out"))
    there = [cells(row)[0] for row in held.splitlines()]
    missing = [bake.name for bake in BAKES if bake.held_out and bake.name not in there]
    parts = [
        "# Maps against direct runs",
        f"""Written by `scripts/validate-map` ({datetime.date.today():%Y-%m-%d}, commit {commit}, {machine}; program, by the first
digits of its SHA-256, direct runs by that of the solver's sources: {", ".join(version[:15 if version.startswith("solver") else 8] for version in versions)}); how maps are made is in [bake.md](bake.md). Errors of a force are shares of the largest mean force that the map has over its solved directions.
What was not run then has the rows of the page before; the program that made a map is in the first table.""",
        *([f"Not run: {', '.join(missing)} in directions held out."] if missing else []),
        "## Bakes", bakes_table(bakes, lines_under(before, "Bakes")),
        "## Directions held out",
        "Eight directions all round that no map was made from. The direct run has the cells of the map's flows, but its record begins "
        f"after {LONG_START} lengths and lasts {LONG_RECORD}, or {LONG_PERIODS} of the map's periods if that is longer: what the map's own flows have of "
        "their start, and of chance, is a part of the error. *Stated* is what the map says of itself: each of its flows predicted from the others.",
        held,
        FLUCTUATIONS, fluctuations_table(bakes, lines_under(before, "Fluctuations there")),
        "## Size", sizes_table(bakes, lines_under(before, "Size")),
        "## Several speeds",
        "The drag of a sphere from a map against a direct run at the same Reynolds number, none of which was baked.",
        speeds_table(speeds or [], lines_under(before, "Several speeds")),
        "## Spin",
        "The torque on the paddle (draft) that turns about its centroid in still water; *xy* lies between the axes that were baked.",
        spin_table(spin or [], lines_under(before, "Spin"))]
    return "\n\n".join(parts) + "\n"
