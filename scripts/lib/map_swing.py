"""How strongly the force of a direct run swings, and how well the run knows it."""
from __future__ import annotations

import math

import numpy


def periodic(force, period):
    """A stretch made periodic as the bake makes its flows (bake/series/periodic.h): what lies beyond the period is faded
    into its beginning."""
    force = force - force.mean(axis=0)
    first, beyond = force[:len(force) - period], force[period:]
    alike = 1.0
    if (energy := math.sqrt((first**2).sum() * (beyond**2).sum())) > 0:
        alike = min(1.0, max(-0.5, (first * beyond).sum() / energy))
    a = (numpy.arange(len(first)) + 0.5) / len(first)
    level = 1 / numpy.sqrt(a * a + (1 - a)**2 + 2 * a * (1 - a) * alike)
    one = force[:period].copy()
    one[:len(first)] = (a * level)[:, None] * first + ((1 - a) * level)[:, None] * beyond
    return one


def of_force(force, duration, period_lengths, harmonics):
    """(strength, its standard error as a share of it, stretches) of a force [sample][component] over `duration` lengths: of each
    stretch that the bake would have made a period of (a period and a quarter, one period apart), with the map's harmonics,
    the root of the mean square over all. What is slower than the period is left out, as it is of the map. The error is
    that of the mean of the stretches, as if they were independent."""
    per_length = len(force) / duration
    record, step = round(1.25 * period_lengths * per_length), period_lengths * per_length
    period = 2 * round(record / 1.25 / 2)
    squares = []
    while (begin := round(len(squares) * step)) + record <= len(force) + 1:
        one = periodic(force[begin:begin + record], period)
        squares.append(2 * (numpy.abs(numpy.fft.rfft(one, axis=0)[1:harmonics + 1] / period)**2).sum())
    mean = sum(squares) / len(squares)
    if not mean > 0 or len(squares) < 2:
        return math.sqrt(mean), 0.0, len(squares)
    spread = math.sqrt(sum((s - mean)**2 for s in squares) / (len(squares) - 1))
    return math.sqrt(mean), 0.5 * spread / mean / math.sqrt(len(squares)), len(squares)


def of_run(path, info, duration):
    force = numpy.loadtxt(path, delimiter=",", skiprows=1, usecols=(1, 2, 3))
    return of_force(force, duration, info["provenance"]["period_lengths"], info["provenance"]["harmonics"])
