"""Holds what a case gave against what is known: deviations, whether the stated uncertainty was honest, the order of
convergence."""
from __future__ import annotations

import math
from dataclasses import dataclass

from flow_cases import Reference, Target, reference

MAGNITUDES = ("cl", "cl_amplitude", "torque_coefficient")  # a torque is against the spin, a side force to any side
STATED = ("cd", "torque_coefficient")  # what the program's uncertainty is of


def number(value):
    """The number, or None for whatever is none: null, missing, NaN."""
    known = isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
    return float(value) if known else None


def measured(record, quantity):
    result = (record or {}).get("result") or {}
    value = number(result.get(quantity))
    if value is not None and quantity == "seconds":
        value = max(value, record["wall_seconds"])  # what the user waits counts
    return abs(value) if value is not None and quantity in MAGNITUDES else value


@dataclass(frozen=True)
class Uncertainty:
    """One standard error, in shares; None where not told."""
    total: float | None = None
    grid: float | None = None
    statistics: float | None = None
    blockage: float | None = None


def stated(record):
    result = (record or {}).get("result") or {}
    parts = result.get("uncertainty_parts")
    parts = parts if isinstance(parts, dict) else {}

    def share(value):
        value = number(value)
        return value if value is not None and value >= 0 else None  # -1: not measured
    return Uncertainty(share(result.get("uncertainty")),
                       *(share(parts.get(name)) for name in ("grid", "statistics", "blockage")))


@dataclass(frozen=True)
class Row:
    """One target of one case. `off` is a share of the reference; None where the case gave no number."""
    case: object
    target: Target
    value: float | None
    known: Reference | None
    off: float | None
    reached: bool
    uncertainty: Uncertainty
    honest: bool | None


def is_honest(value, known, uncertainty):
    """Whether the reference is where the run's own statement lets it be: the distance is no more than twice the
    standard error and half the width of the reference's band, as a root of squares."""
    return abs(value - known.value) <= math.hypot(2 * uncertainty * value, (known.high - known.low) / 2)


def rows(case, record):
    for target in case.targets:
        value = measured(record, target.quantity)
        if target.at_most:
            reached = value is not None and value <= target.at_most
            yield Row(case, target, value, None, None, reached, Uncertainty(), None)
            continue
        known = reference(case, target)
        own = stated(record) if target.quantity in STATED else Uncertainty()
        off = None if value is None else value / known.value - 1
        honest = None if value is None or own.total is None else is_honest(value, known, own.total)
        yield Row(case, target, value, known, off, off is not None and abs(off) <= target.percent / 100, own, honest)


@dataclass(frozen=True)
class Turned:
    """A case on a turned lattice against the one it is like."""
    case: object
    plain: float | None
    turned: float | None
    change: float | None
    reached: bool
    statistics: float | None  # standard error of the change, as far as the two runs tell it


def turned(case, record, other):
    plain, value = measured(other, "cd"), measured(record, "cd")
    change = None if plain is None or value is None else value / plain - 1
    parts = [stated(one).statistics for one in (record, other)]
    return Turned(case, plain, value, change, change is not None and abs(change) <= case.percent / 100,
                  None if None in parts else math.hypot(*parts))


@dataclass(frozen=True)
class Convergence:
    order: float | None
    limit: float | None  # the value at a cell of no size
    residual: float | None  # root of the mean square, a share of the limit
    remark: str = ""


ORDERS = [n / 100 for n in range(25, 501)]


def line(x, y):
    """Least squares y = a + b x: a, b, sum of squares."""
    n = len(x)
    mx, my = sum(x) / n, sum(y) / n
    b = sum((p - mx) * (q - my) for p, q in zip(x, y)) / sum((p - mx) ** 2 for p in x)
    a = my - b * mx
    return a, b, sum((q - a - b * p) ** 2 for p, q in zip(x, y))


def convergence(resolutions, values, errors=None):
    """The order p and the limit f of `values` = f + c / resolution^p by least squares (Richardson's extrapolation,
    with more runs than unknowns). `errors`: standard errors of the values, for the question whether there is anything
    to be told at all."""
    if len(values) < 3:
        return Convergence(None, None, None, "needs three runs")
    spread = max(values) - min(values)
    if errors and spread <= 2 * math.sqrt(2) * max(errors):
        return Convergence(None, sum(values) / len(values), None,
                           "the runs differ by no more than their statistics: no order can be told, the limit is their "
                           "mean")
    fits = []
    for order in ORDERS:
        a, _, squares = line([(resolutions[0] / n) ** order for n in resolutions], values)
        fits.append((squares, order, a))
    squares, order, limit = min(fits)
    residual = math.sqrt(squares / len(values)) / abs(limit)
    if order in (ORDERS[0], ORDERS[-1]):
        return Convergence(None, None, None,
                           f"no order between {ORDERS[0]:g} and {ORDERS[-1]:g} fits best: these cells do not show one")
    remark = ""
    if residual * abs(limit) > spread / 4:
        remark = "the runs are far from the fit: the order says little"
    return Convergence(order, limit, residual, remark)


def failures(cases, records):
    """A line for each thing that must be reached and is not."""
    for case in cases:
        record = records.get(case.name)
        if record is None or "error" in record:
            yield f"{case.name}: {record['error'] if record else 'not measured'}"
            continue
        for row in rows(case, record):
            if not row.reached:
                yield f"{case.name}: {row.target.quantity} {describe(row)}"
        if case.like and case.like in records:
            t = turned(case, record, records[case.like])
            if not t.reached:
                yield f"{case.name}: " + ("no drag to compare" if t.change is None else
                                          f"drag changes by {100 * t.change:+.1f} %, {case.percent:g} % allowed")


def describe(row):
    if row.value is None:
        return "is not reported"
    if row.off is None:
        return f"{row.value:.4g}, at most {row.target.at_most:g}"
    return f"{row.value:.4g}, {100 * row.off:+.1f} % ({row.target.percent:g} % allowed)"
