"""Means, quantiles and probabilities of a sample, each with the ends of its confidence interval.

An interval end that the sample is too small for is None. Distributions are those of scipy.special: scipy.stats takes three times
as long to load.
"""

import functools
import math

import numpy as np

from .errors import NotWanted

CONFIDENCE = 0.95


@functools.cache
def special():
    """Functions of scipy.special."""
    try:
        from scipy import special as functions
    except ImportError:
        raise NotWanted("Python's module scipy is not installed; first run: sh pipelines/setup.sh studies") from None
    return functions


@functools.cache
def student_factor(freedom):
    """Half of Student's interval over the standard error."""
    return float(special().stdtrit(freedom, (1 + CONFIDENCE) / 2))


def student(mean, variance, freedom):
    """Mean and ends of Student's interval, from the variance of the mean and its degrees of freedom."""
    half = student_factor(freedom) * math.sqrt(variance)
    return mean, mean - half, mean + half


def mean(values):
    """Of independent values: mean and ends of Student's interval."""
    if len(values) < 2:
        return (float(values[0]) if len(values) else None), None, None
    return student(float(np.mean(values)), float(np.var(values, ddof=1)) / len(values), len(values) - 1)


def mean_of_parts(values, part):
    """Of values in independent parts, such as replicates of a Latin hypercube: mean, and ends of Student's interval of the parts'
    means. part [value]: its number."""
    means = [float(np.mean(values[part == one])) for one in np.unique(part)]
    if len(means) < 2:
        return mean(values)
    _, low, high = mean(means)
    middle = float(np.mean(values))
    half = (high - low) / 2
    return middle, middle - half, middle + half


def mean_by_control(values, control):
    """Of independent pairs: mean of the values by a control variate whose own mean is known to be 0, and ends of Student's interval.

    A value less a factor times its control has the same mean, whatever the factor, and the least variance by the factor of least
    squares. Here each pair has that of all other pairs, so that the mean is not biased (Avramidis and Wilson 1993, splitting).
    """
    n = len(values)
    if n < 4:
        return (float(np.mean(values)) if n else None), None, None
    of_control, of_values, products, squares = (part.sum() - part for part in (control, values, values * control, control**2))
    spread = squares - of_control**2 / (n - 1)
    if not (spread > 0).all():
        return mean(values)
    left = values - (products - of_values * of_control / (n - 1)) / spread * control
    return student(float(left.mean()), float(left.var(ddof=1)) / n, n - 2)


def crossed(table):
    """Of a table [network, parameters]: sums of squares over their degrees of freedom, of networks, of parameters, and of what
    both together make beside that (two-way analysis of variance with random effects, one value a cell)."""
    networks, parameters = table.shape
    middle, of_networks, of_parameters = table.mean(), table.mean(axis=1), table.mean(axis=0)
    rest = table - of_networks[:, None] - of_parameters[None, :] + middle
    return (parameters * float(((of_networks - middle) ** 2).sum()) / (networks - 1),
            networks * float(((of_parameters - middle) ** 2).sum()) / (parameters - 1),
            float((rest**2).sum()) / ((networks - 1) * (parameters - 1)))


def mean_of_crossed(table):
    """Of a table [network, parameters]: mean, and ends of an interval with the degrees of freedom of Satterthwaite. Values that
    share a network or a set of parameters are not independent."""
    networks, parameters = table.shape
    by_network, by_parameter, rest = crossed(table)
    total = by_network + by_parameter - rest
    if total <= max(by_network, by_parameter):  # the negative term is noise
        total = max(by_network, by_parameter)
        freedom = networks - 1 if by_network >= by_parameter else parameters - 1
    else:
        freedom = total**2 / (by_network**2 / (networks - 1) + by_parameter**2 / (parameters - 1) +
                              rest**2 / ((networks - 1) * (parameters - 1)))
    return student(float(table.mean()), total / table.size, freedom) if total > 0 else (float(table.mean()),) * 3


@functools.cache
def ranks(n, probability):
    """Ranks of the ordered values, counted from 1, between which the quantile of n values is with the confidence at least, by the
    binomial distribution of how many are below it; 0 and n + 1 are no values."""
    at_most, tail = special().bdtr(np.arange(n + 1), n, probability), (1 - CONFIDENCE) / 2
    return int(np.searchsorted(at_most, tail)), int(np.searchsorted(at_most, 1 - tail)) + 1


def quantile(values, probability):
    """Of independent values: quantile, and the ends of its interval by order statistics."""
    ordered = np.sort(values)
    n = len(ordered)
    low, high = ranks(n, probability)
    return (float(np.quantile(ordered, probability)), float(ordered[low - 1]) if low >= 1 else None,
            float(ordered[high - 1]) if high <= n else None)


@functools.lru_cache(maxsize=100000)
def probability(count, n):
    """Of `count` in `n` independent trials: share, and ends of the interval of Clopper and Pearson."""
    if n == 0:
        return None, None, None
    tail = (1 - CONFIDENCE) / 2
    low = float(special().btdtri(count, n - count + 1, tail)) if count > 0 else 0.0
    high = float(special().btdtri(count + 1, n - count, 1 - tail)) if count < n else 1.0
    return count / n, low, high
