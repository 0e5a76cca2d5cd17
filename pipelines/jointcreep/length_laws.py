"""Laws of trace length from traces that a window cuts: maximum likelihood, its intervals, and checks on traces held back.

The law is that of all traces, each counted once wherever it lies: what a joint set's `length` means. A window meets long
traces more often than short ones, and cuts them. Midpoints being anywhere (Poisson), of a law with density f and survival S, and
with G(x) the integral of S from x on, the traces of one direction appear in a convex window in proportion to

    f(l)     with both ends inside and length l,
    S(v)     with one end inside, v being seen of them,
    G(c)     with no end inside, c being the chord,

in all to A S(t) + w G(t), where t is the shortest length that was mapped, A the area above chords of length t and w the width in
which chords are that long (without t: area, width and mean length). The likelihood is the product of these over the traces, each
divided by that total (Laslett 1982, Mathematical Geology 14, 125-140, without his intensity).

Of the traces whose first end is inside, lengths are a fair sample of the law, censored at the window's edge: those give
Kaplan and Meier's curve, and the check on traces held back.
"""

import dataclasses
import math
from collections.abc import Callable

import numpy as np
from scipy import optimize, special, stats

from .errors import NotWanted

FOLDS = 5  # each is held back once
LIKELIHOOD_DROP = stats.chi2.ppf(0.95, 1) / 2  # at the ends of a 95 percent interval


@dataclasses.dataclass(frozen=True)
class Law:
    """A law as a scene names it. Functions take its constants, then lengths [m]."""

    word: str
    constants: tuple[str, ...]  # keys of the scene that are fitted; all above 0
    survival: Callable
    density: Callable
    beyond: Callable  # the integral of the survival from a length on [m]
    start: Callable  # constants to begin with, from a mean
    fixed: tuple = ()  # further keys of the scene, with their values

    def mean(self, constants):
        return float(self.beyond(constants, np.array([0.0]))[0])


def exponential():
    return Law("negative exponential", ("mean_m",), lambda c, x: np.exp(-x / c[0]), lambda c, x: np.exp(-x / c[0]) / c[0],
               lambda c, x: c[0] * np.exp(-x / c[0]), lambda mean: [mean])


def lognormal():
    def logs(c):
        variance = math.log1p((c[1] / c[0]) ** 2)
        return math.log(c[0]) - variance / 2, math.sqrt(variance)

    def standard(c, x):
        mean, deviation = logs(c)
        with np.errstate(divide="ignore"):
            return (np.log(x) - mean) / deviation

    def beyond(c, x):
        z = standard(c, x)
        return c[0] * special.ndtr(logs(c)[1] - z) - x * special.ndtr(-z)

    return Law("lognormal", ("mean_m", "deviation_m"), lambda c, x: special.ndtr(-standard(c, x)),
               lambda c, x: np.exp(-standard(c, x) ** 2 / 2) / (x * logs(c)[1] * math.sqrt(2 * math.pi)), beyond,
               lambda mean: [mean, 0.7 * mean])


def normal():
    """Of lengths above 0, as jointgen draws it."""
    def share(c):
        return special.ndtr(c[0] / c[1])

    def beyond(c, x):
        z = (c[0] - x) / c[1]
        return ((c[0] - x) * special.ndtr(z) + c[1] * np.exp(-z**2 / 2) / math.sqrt(2 * math.pi)) / share(c)

    return Law("normal", ("mean_m", "deviation_m"), lambda c, x: special.ndtr((c[0] - x) / c[1]) / share(c),
               lambda c, x: np.exp(-((x - c[0]) / c[1]) ** 2 / 2) / (c[1] * math.sqrt(2 * math.pi) * share(c)), beyond,
               lambda mean: [mean, 0.3 * mean])


def power(shortest, longest):
    """With cut-offs that are given."""
    def integral(q, x):  # of u^(q - 1) from x to the longest
        logs = np.log(longest / x)
        return x**q * logs * special.exprel(q * logs)

    def within(x):
        return np.clip(x, shortest, longest)

    def survival(c, x):
        return integral(1 - c[0], within(x)) / integral(1 - c[0], shortest)

    def density(c, x):
        return np.where((x >= shortest) & (x <= longest), within(x) ** -c[0] / integral(1 - c[0], shortest), 0.0)

    def beyond(c, x):
        at = within(x)
        mean = (integral(2 - c[0], at) - at * integral(1 - c[0], at)) / integral(1 - c[0], shortest)
        return mean + np.maximum(shortest - x, 0)

    return Law("power", ("exponent",), survival, density, beyond, lambda mean: [2.0],
               (("shortest_m", shortest), ("longest_m", longest)))


def laws(shortest, longest):
    """Those that can be fitted. A power law needs its cut-offs."""
    found = [exponential(), lognormal(), normal()]
    return found + [power(shortest, longest)] if shortest and longest else found


def log_likelihoods(law, constants, seen):
    """Of each trace, given that the window shows it."""
    shortest = np.array([seen.shortest])
    with np.errstate(all="ignore"):
        appear = np.choose(seen.cut_ends, [law.density(constants, seen.length), law.survival(constants, seen.length),
                                           law.beyond(constants, seen.length)])
        in_all = seen.chord_area * law.survival(constants, shortest) + seen.chord_width * law.beyond(constants, shortest)
        values = np.log(appear) - np.log(in_all)
    return np.where(np.isfinite(values), values, -1e10)


def naive_log_likelihoods(law, constants, seen):
    """As if every length were seen whole, and every trace met as easily as another."""
    with np.errstate(all="ignore"):
        values = np.log(law.density(constants, seen.length)) - np.log(law.survival(constants, np.array([seen.shortest])))
    return np.where(np.isfinite(values), values, -1e10)


@dataclasses.dataclass(frozen=True)
class Fit:
    law: Law
    constants: np.ndarray
    log_likelihood: float
    intervals: tuple = ()  # of 95 percent, (low, high) of each constant; infinite where the traces set no limit


class Likelihood:
    """The log-likelihood of a law over the logarithms of its constants."""

    def __init__(self, law, seen, of_each=log_likelihoods):
        self.law, self.seen, self.of_each = law, seen, of_each

    def lost(self, logarithms):
        if np.abs(logarithms).max() > 20:
            return 1e12
        return -self.of_each(self.law, np.exp(logarithms), self.seen).sum()

    def best(self, start, held=None):
        """Where it is largest, from a start; with one constant held if that is given as (place, logarithm)."""
        free = [i for i in range(len(start)) if held is None or i != held[0]]

        def whole(values):
            at = np.array(start, float)
            at[free] = values
            if held:
                at[held[0]] = held[1]
            return at

        if not free:
            return whole([]), -self.lost(whole([]))
        found = optimize.minimize(lambda values: self.lost(whole(values)), np.array(start, float)[free], method="Nelder-Mead",
                                  options={"xatol": 1e-6, "fatol": 1e-8, "maxiter": 4000})
        return whole(found.x), -found.fun

    def interval(self, best, largest, place):
        """By the likelihood's profile: where it falls by chi squared over 2."""
        ends = []
        for way in -1, 1:
            start = best

            def above(logarithm):
                nonlocal start
                start, value = self.best(start, (place, logarithm))
                return value - largest + LIKELIHOOD_DROP

            inside, step = best[place], 0.05
            while above(inside + way * step) > 0:
                inside, step = inside + way * step, 2 * step
                if step > 8:
                    break
            ends.append(way * math.inf if step > 8 else optimize.brentq(above, inside, inside + way * step, xtol=1e-5))
        return math.exp(ends[0]), math.exp(ends[1])


def fit(law, seen, of_each=log_likelihoods, with_intervals=True):
    """The law by maximum likelihood."""
    likelihood = Likelihood(law, seen, of_each)
    best, largest = likelihood.best(np.log(law.start(seen.length.mean())))
    best, largest = likelihood.best(best)  # again, with a fresh simplex
    if largest < -1e9 or np.abs(best).max() > 15:
        return None
    intervals = tuple(likelihood.interval(best, largest, i) for i in range(len(best))) if with_intervals else ()
    return Fit(law, np.exp(best), largest, intervals)


@dataclasses.dataclass(frozen=True)
class Check:
    """What a law says of traces that it was not fitted to."""

    log_likelihood: float  # mean of a trace
    distance: float  # Kolmogorov and Smirnov's
    p: float
    number: int  # of lengths that the distance is of


def places_by_law(law, constants, seen):
    """Of traces whose first end is inside, and whose other end is, too: their places in the law, between the shortest length and
    the window's edge. Uniform from 0 to 1 if the law is right."""
    whole = (seen.cut_ends == 0) & (seen.room > seen.shortest)
    shortest, room, length = (law.survival(constants, x) for x in (np.array([seen.shortest]), seen.room[whole], seen.length[whole]))
    return np.clip((shortest - length) / np.maximum(shortest - room, 1e-300), 0, 1)


def held_back(law, seen, seed=0):
    """Each fifth of the traces by the law fitted to the others. None where that cannot be fitted."""
    order = np.random.default_rng(seed).permutation(len(seen))
    values, places = [], []
    for fold in range(FOLDS):
        out = np.isin(np.arange(len(seen)), order[fold::FOLDS])
        found = fit(law, seen.part(~out), with_intervals=False)
        if found is None:
            return None
        values.append(log_likelihoods(law, found.constants, seen.part(out)))
        places.append(places_by_law(law, found.constants, seen.part(out)))
    places = np.concatenate(places)
    distance, p = stats.kstest(places, "uniform") if len(places) else (math.nan, math.nan)
    return Check(float(np.concatenate(values).mean()), float(distance), float(p), len(places))


def kaplan_meier(seen):
    """The share of traces longer than a length, of those longer than the shortest mapped: lengths [m] and shares after them."""
    first = ~seen.cut[:, 0]
    length, ends = seen.length[first], ~seen.cut[first, 1]
    at = np.unique(length[ends])
    longer = (length[None, :] >= at[:, None]).sum(axis=1)
    ended = ((length == at[:, None]) & ends).sum(axis=1)
    return at, np.cumprod(1 - ended / longer)


def density(found, seen):
    """Traces per area [1/m2], and their length per area [1/m] with its 95 percent interval."""
    shortest = np.array([seen.shortest])
    share = seen.chord_area * found.law.survival(found.constants, shortest) + seen.chord_width * found.law.beyond(
        found.constants, shortest)
    p20 = float((1 / share).sum())
    p21 = p20 * found.law.mean(found.constants)
    factor = math.exp(1.96 * math.sqrt((seen.length**2).sum()) / seen.length.sum())  # a compound Poisson number
    return p20, p21, (p21 / factor, p21 * factor)


def enough(seen, what):
    """Refuses traces that say too little of lengths."""
    ends = int((2 - seen.cut_ends).sum())
    if len(seen) < 10 or ends < 10:
        raise NotWanted(f"{what}: the window shows {len(seen)} traces with {ends} ends inside; expected 10 of both or more")
