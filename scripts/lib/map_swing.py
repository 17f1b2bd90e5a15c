"""How strongly the force of a direct run swings, and how well the run knows it."""
from __future__ import annotations

import math

import numpy


def of_run(path, info):
    """(strength, its standard error as a share of it) of the force in a run's series, made periodic as the bake makes its
    flows (bake/series/periodic.h): the first period of the map, what lies beyond it faded into its beginning, the map's
    harmonics. What is slower than the period is left out, as it is of the map: the run has not one cycle of it, and
    most of it is what is left of the start.

    The error is that of the variance of a Gaussian process: with s_k the power of harmonic k of one component, of which a
    record shows one sample with a variance of s_k^2, sqrt(sum s_k^2) / sum s_k; of its root half as much. A record's own
    power has a mean square of 2 s_k^2, hence the half under the root."""
    force = numpy.loadtxt(path, delimiter=",", skiprows=1, usecols=(1, 2, 3))
    force -= force.mean(axis=0)
    # The run lasts a period and a quarter (scripts/validate-map, as_baked()).
    period = 2 * round(len(force) / 1.25 / 2)
    first, beyond = force[:len(force) - period], force[period:]
    alike = 1.0
    if (energy := math.sqrt((first**2).sum() * (beyond**2).sum())) > 0:
        alike = min(1.0, max(-0.5, (first * beyond).sum() / energy))
    a = (numpy.arange(len(first)) + 0.5) / len(first)
    level = 1 / numpy.sqrt(a * a + (1 - a)**2 + 2 * a * (1 - a) * alike)
    one = force[:period].copy()
    one[:len(first)] = (a * level)[:, None] * first + ((1 - a) * level)[:, None] * beyond
    harmonics = info["provenance"]["harmonics"]
    power = 2 * numpy.abs(numpy.fft.rfft(one, axis=0)[1:harmonics + 1] / period)**2
    whole = power.sum()
    if not whole > 0:
        return 0.0, 0.0
    return math.sqrt(whole), 0.5 * math.sqrt((power**2).sum() / 2) / whole
