"""Means, quantiles and probabilities of a sample, each with the ends of its confidence interval; means also with the standard error.

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
    except ModuleNotFoundError:
        raise NotWanted("Python's module scipy is not installed; first run: sh pipelines/setup.sh studies") from None
    return functions


@functools.cache
def student_factor(freedom):
    """Half of Student's interval over the standard error."""
    return float(special().stdtrit(freedom, (1 + CONFIDENCE) / 2))


def student(mean, variance, freedom):
    """Mean, ends of Student's interval, and standard error, from the variance of the mean and its degrees of freedom."""
    error = math.sqrt(variance)
    half = student_factor(freedom) * error
    return mean, mean - half, mean + half, error


def mean(values):
    """Of independent values: mean, ends of Student's interval, and standard error."""
    if len(values) < 2:
        return (float(values[0]) if len(values) else None), None, None, None
    return student(float(np.mean(values)), float(np.var(values, ddof=1)) / len(values), len(values) - 1)


def mean_of_parts(values, part):
    """Of values in independent parts, such as replicates of a Latin hypercube: mean, and ends of Student's interval and
    standard error of the parts' means. part [value]: its number."""
    means = [float(np.mean(values[part == one])) for one in np.unique(part)]
    if len(means) < 2:
        return mean(values)
    *_, error = mean(means)
    return student(float(np.mean(values)), error**2, len(means) - 1)


def mean_by_control(values, control):
    """Of independent pairs: mean of the values by a control variate whose own mean is known to be 0, ends of Student's interval,
    and standard error.

    A value less a factor times its control has the same mean, whatever the factor, and the least variance by the factor of least
    squares. Here each pair has that of all other pairs, so that the mean is not biased (Avramidis and Wilson 1993, splitting).
    """
    n = len(values)
    if n < 4:
        return (float(np.mean(values)) if n else None), None, None, None
    of_control, of_values, products, squares = (part.sum() - part for part in (control, values, values * control, control**2))
    spread = squares - of_control**2 / (n - 1)
    if not (spread > 0).all():
        return mean(values)
    left = values - (products - of_values * of_control / (n - 1)) / spread * control
    return student(float(left.mean()), float(left.var(ddof=1)) / n, n - 2)


def additive(table):
    """The effects of networks and of parameters that fit a table [network, parameters] best by least squares (their sum, no more); nan
    where there is no value, but no row and no column is empty. Returns the effects, what is left of each value (0 where there is none),
    and the degrees of freedom of what is left."""
    there = np.isfinite(table)
    in_row, in_column = there.sum(axis=1), there.sum(axis=0)
    middle = np.nanmean(table)
    values = np.where(there, table - middle, 0.0)
    values = np.where(there, values - (values.sum(axis=1) / in_row)[:, None], 0.0)  # networks are eliminated
    matrix = np.diag(in_column).astype(float) - there.T @ (there / in_row[:, None])
    of_parameters, _, rank, _ = np.linalg.lstsq(matrix, values.sum(axis=0), rcond=1e-9)
    rest = np.where(there, values - of_parameters + (there @ of_parameters / in_row)[:, None], 0.0)
    of_networks = (np.where(there, table - middle - of_parameters, 0.0)).sum(axis=1) / in_row
    return of_networks, of_parameters, rest, int(there.sum()) - len(table) - int(rank)


def components(table):
    """Components of the variance of a table [network, parameters] with random effects of both, of which some values may be missing (nan,
    but no empty row or column): of networks, of parameters, and of what both together make beside that. No bias, whichever values are
    missing, if that has nothing to do with their size. Of a full table those of the two-way analysis of variance.

    The last one is that of the least squares of additive(). The squares within rows and within columns then give the others, because
    their means are those of both less one component (Searle, Casella and McCulloch 1992, chapter 5). They may be negative. None
    if the table is too small."""
    there = np.isfinite(table)
    _, _, rest, freedom = additive(table)
    in_row, in_column, n = there.sum(axis=1), there.sum(axis=0), int(there.sum())
    if freedom < 1 or n == len(table) or n == table.shape[1]:
        return None
    values = np.where(there, table - np.nanmean(table), 0.0)
    squares = float((values**2).sum())
    within_rows = squares - float((values.sum(axis=1) ** 2 / in_row).sum())
    within_columns = squares - float((values.sum(axis=0) ** 2 / in_column).sum())
    of_both = float((rest**2).sum()) / freedom
    return within_columns / (n - table.shape[1]) - of_both, within_rows / (n - len(table)) - of_both, of_both


def mean_of_crossed(table):
    """Of a table [network, parameters], of which some values may be missing (nan): mean of the values, ends of an interval with the
    degrees of freedom of Satterthwaite, and standard error. Values that share a network or a set of parameters are not independent.

    The mean is a ratio, of the sum of values and their number, and both depend on the networks. So its variance is that of the mean of a
    full table: of the differences from the mean, 0 where there is no value, over the share of values (linearization of a ratio,
    Cochran 1977, chapter 6)."""
    networks, parameters = table.shape
    there = np.isfinite(table)
    middle = float(table[there].mean())
    found = components(np.where(there, table - middle, 0.0) / there.mean())
    if found is None:
        return middle, None, None, None
    of_network, of_parameters, rest = found
    by_network, by_parameter = rest + parameters * of_network, rest + networks * of_parameters  # mean squares
    total = by_network + by_parameter - rest
    if total <= max(by_network, by_parameter):  # the negative term is noise
        total = max(by_network, by_parameter)
        freedom = networks - 1 if by_network >= by_parameter else parameters - 1
    else:
        freedom = total**2 / (by_network**2 / (networks - 1) + by_parameter**2 / (parameters - 1) +
                              rest**2 / ((networks - 1) * (parameters - 1)))
    return student(middle, max(0.0, total) / table.size, freedom if total > 0 else 1)


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
    """Of `count` in `n` independent trials: share, and ends of the interval of Clopper and Pearson. Neither need be whole."""
    if n == 0:
        return None, None, None
    tail = (1 - CONFIDENCE) / 2
    low = float(special().betaincinv(count, n - count + 1, tail)) if count > 0 else 0.0
    high = float(special().betaincinv(count + 1, n - count, 1 - tail)) if count < n else 1.0
    return count / n, low, high


def probability_of_crossed(table):
    """Of a table [network, parameters] of 0 and 1, of which some may be missing (nan): share of 1, and ends of an interval of Clopper
    and Pearson, of as many independent trials as have the standard error that the table's mean has (Korn and Graubard 1998); without
    scatter, of as many as there are networks or parameters, if these are fewer."""
    n, fewer = int(np.isfinite(table).sum()), min(table.shape)
    share, low, high, error = mean_of_crossed(table)
    if share in (0, 1):
        return probability(share * fewer, fewer)
    if not error:
        return share, None, None
    factor = (high - share) / error  # Student's
    trials = min(n, share * (1 - share) / error**2 * (student_factor(n - 1) / factor) ** 2)
    return share, *probability(share * trials, trials)[1:]
