"""The page docs/validation-map.md from what scripts/validate-map gathered."""
from __future__ import annotations

import datetime
import math

from map_cases import BODIES, SPEED_PERCENT, SPIN_PERCENT


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "| " + " | ".join("---" for _ in head) + " |"]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def percent(share, digits=1):
    return f"{100 * share:.{digits}f} %"


def seconds(value):
    return f"{value:.0f} s" if value < 120 else f"{value / 60:.0f} min"


def verdict(good):
    return "yes" if good else "**no**"


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def held_out(made):
    """(rms, worst) of the mean force as shares of the peak; (map's, run's) strength of the fluctuation, rms over directions."""
    errors = [math.hypot(*minus(one["map"]["force_mean"], one["run"]["force_mean"])) / made["peak"] for one in made["held"]]
    swing = [[math.hypot(*one[who]["force_rms"]) for one in made["held"]] for who in ("map", "run")]
    ratios = [a / b for a, b in zip(*swing) if b > 0]
    return math.sqrt(sum(e * e for e in errors) / len(errors)), max(errors), ratios


def bakes_table(bakes):
    rows = []
    for made in bakes:
        bake, result = made["bake"], made["made"]["result"]
        asked = f"{seconds(bake.longest)}: {verdict(made['made']['seconds'] <= bake.longest)}" if bake.longest else "–"
        rows.append((bake.name, BODIES[bake.body].title, len(made["info"]["provenance"]["directions"]), made["info"]["sources"],
                     seconds(made["made"]["seconds"]), asked))
    return table(("map", "object", "flows", "sources", "time", "asked"), rows)


def directions_table(bakes):
    rows = []
    for made in bakes:
        if not made["held"]:
            continue
        rms, worst, _ = held_out(made)
        asked, info = made["bake"].asked, made["info"]
        rows.append((made["bake"].name, percent(rms), percent(worst),
                     f"{percent(asked[0], 0)}, {percent(asked[1], 0)}: {verdict(rms <= asked[0] and worst <= asked[1])}" if asked else "–",
                     percent(info["direction_error_rms"]), percent(info["direction_error_worst"]),
                     percent(sum(one["run"]["uncertainty"] for one in made["held"]) / len(made["held"]))))
    return table(("map", "rms", "worst", "asked", "stated rms", "stated worst", "runs' own uncertainty"), rows)


def fluctuations_table(bakes):
    rows = []
    for made in bakes:
        if not made["held"]:
            continue
        _, _, ratios = held_out(made)
        mean = math.exp(sum(map(math.log, ratios)) / len(ratios)) if ratios and min(ratios) > 0 else float("nan")
        rows.append((made["bake"].name, f"{mean:.2f}", f"{min(ratios):.2f} to {max(ratios):.2f}",
                     sum(abs(r - 1) <= 0.1 for r in ratios), len(ratios)))
    return table(("map", "strength, map over run (geometric mean)", "range", "within 10 %", "of"), rows)


def sizes_table(bakes):
    rows = []
    for made in bakes:
        size, limit = made["made"]["result"]["file_bytes"] / 1e3, made["bake"].kilobytes
        stated = made["info"]["quantisation_error"]
        found = made["verified"]["quantisation_error"]
        rows.append((made["bake"].name, f"{size:.0f} kB", f"{limit:.0f} kB: {verdict(size <= limit and stated < 0.01)}" if limit else "–",
                     percent(stated, 2), percent(found, 2), f"{made['raw_bytes'] / 1e3:.0f} kB"))
    return table(("map", "file", "asked", "stated error", "found against the raw tables", "raw tables, fp32 by zstd"), rows)


def speeds_table(rows):
    out = []
    for row in rows:
        several, one = row["several"] / row["run"] - 1, row["one"] / row["run"] - 1
        out.append((f"{row['reynolds']:,}", percent(several), percent(one), verdict(abs(several) <= SPEED_PERCENT / 100)))
    return table(("Reynolds number", "map of five speeds", "map of one (Re 1,000)", f"within {SPEED_PERCENT} %"), out)


def spin_table(rows):
    out = []
    for row in rows:
        if not {"with", "without", "run"} <= row.keys():
            continue
        off = row["with"] / row["run"] - 1
        out.append((row["axis"], f"{row['run']:.3g} N m", percent(off), percent(row["without"] / row["run"] - 1),
                    percent(row["uncertainty"]), verdict(abs(off) <= SPIN_PERCENT / 100)))
    return table(("axis", "direct run", "map with spins", "paper's rule", "run's own uncertainty", f"within {SPIN_PERCENT} %"), out)


def page(bakes, speeds, spin, commit, machine, versions, missing):
    parts = [f"""# Maps against direct runs

Written by `scripts/validate-map` ({datetime.date.today():%Y-%m-%d}, commit {commit}, {machine}; program, by the first
digits of its SHA-256: {", ".join(version[:8] for version in versions)}); how maps are made is in [bake.md](bake.md). Errors of a force are shares of the largest mean force that the map has over its solved directions."""]
    if missing:
        parts.append(f"Not run: {len(missing)} steps, among them {', '.join(missing[:4])}.")
    if bakes:
        parts += ["## Bakes", bakes_table(bakes),
                  "## Directions held out\n\nEight directions all round that no map was made from; the direct run has the cells, the start and the duration of the "
                  "map's own flows. *Stated* is what the map says of itself: each of its flows predicted from the others.",
                  directions_table(bakes),
                  "## Fluctuations there\n\nThe rms of the force about its mean, of the map over that of the run.", fluctuations_table(bakes),
                  "## Size", sizes_table(bakes)]
    if speeds:
        parts += ["## Several speeds\n\nThe drag of a sphere from a map against a direct run at the same Reynolds number, none of which was baked.",
                  speeds_table(speeds)]
    if spin:
        parts += ["## Spin\n\nThe torque on the paddle (draft) that turns about its centroid in still water; *xy* lies between the axes that were baked.",
                  spin_table(spin)]
    return "\n\n".join(parts) + "\n"
