"""What a study answers: means, quantiles and probabilities with confidence, how they converge, and shares of the variance.

A factor of safety that is only known to be 64 or more is not in means; see is_beyond().

Only runs that have a value count: a run without an equilibrium, or whose point an excavation has taken, is named in the summary.
Probabilities "or no equilibrium" and that to fail also count the runs whose blocks move. A run that ended undecided is neither stable nor
failed: with such runs, these probabilities have two rows, "at least" (none of them counts) and "at most" (all of them do).
"""

import collections
import dataclasses
import itertools
import math
import re
import textwrap

import numpy as np

from . import failure, files, intervals
from .design import calls_openturns, openturns
from .intervals import CONFIDENCE
from .quantities import MOVING, NO_EQUILIBRIUM, TO_FAIL, UNDECIDED, ending_of, file_of
from .study_file import BY_STOP_RULE, ENDS, EXTENSIBLE, NETWORK

QUANTILES = [0.05, 0.25, 0.50, 0.75, 0.95]
CORRELATION = "rank correlation"  # a measure in shares.csv
ALL_PARAMETERS = "all parameters"  # an input in shares.csv
NOT_LINEAR = "curvature and interaction of parameters"  # what no parameter explains alone
SETS_EACH = 4  # sets of parameters for each parameter, so that their share is divided
OF_STABLE, OR_NONE = ", of stable runs", " or no equilibrium"  # ends of names of probabilities
FEWEST = 10  # values from which convergence is shown
FEWEST_OF_BOTH = 5  # failures and stable runs, for the rank correlation of failed
FEWEST_NETWORKS = 4  # of networks x parameters from which it is shown
STEPS = 30  # numbers of runs at which it is shown, at most
NAMED = 20  # failed runs that the summary lists
SHORT = 90  # characters of a reason there
LARGEST_FACTOR = 64  # that the search of a factor of safety tries


def is_beyond(study, row, at):
    """Whether a quantity is an end of the factor of safety of a run that is stable at the largest factor: it is that or more, which is no
    value."""
    if study.quantities[at].what != "factor of safety":
        return False
    low, high = row["values"][lower_end(study, at):][:2]
    return low is not None and low >= LARGEST_FACTOR and high is None


def lower_end(study, at):
    """The place of the lower end of a factor of safety, of which this is one end; the upper end follows."""
    return at if study.quantities[at].statistic == ENDS[0] else at - 1


def value_of(study, row, at):
    """Value of a quantity of a run; None where there is none, or only a bound."""
    return None if is_beyond(study, row, at) else row["values"][at]


def values_of(study, rows, at):
    """Values of a quantity and the numbers of their runs, as arrays; of runs that are independent of each other, as far as the
    design has such. Sobol indices: the first two of its matrices are. Two levels: the fine runs of whole blocks whose coarse run on
    the same network has a value too."""
    value = {row["run"]: value_of(study, row, at) for row in rows if value_of(study, row, at) is not None}
    there = sorted(value)
    if study.design.fine_runs:
        whole = whole_blocks(study, rows)
        there = [run for run in there if run in whole and run + 1 in value]
    elif study.design.kind == "sobol indices":
        there = [run for run in there if run < 2 * study.design.points]
    return np.array([value[run] for run in there], float), np.array(there, int)


def whole_blocks(study, rows):
    """Fine runs of two levels whose block has all its runs."""
    ended = {row["run"] for row in rows}
    return {run for run in ended if study.design.level(run) == "fine" and ended.issuperset(range(run, run + study.design.block()))}


def coarse_of(study, rows, at, run):
    """Of two levels: for each of these fine runs the value of the coarse run on its network, and the mean of all coarse runs of its
    block, [run, 2]. None for other designs."""
    if not study.design.fine_runs:
        return None
    value = {row["run"]: value_of(study, row, at) for row in rows}
    blocks = [[value[one + place] for place in range(1, study.design.block())] for one in run]
    return np.array([[block[0], np.mean([one for one in block if one is not None])] for block in blocks]).reshape(-1, 2)


def counted_runs(study, rows, is_one):
    """Numbers of runs for which is_one(row) holds, of those that values_of() may have."""
    last = 2 * study.design.points if study.design.kind == "sobol indices" else study.design.runs
    counted = whole_blocks(study, rows) if study.design.fine_runs else range(last)
    return np.array([row["run"] for row in rows if row["run"] in counted and is_one(row)], int)


@dataclasses.dataclass
class NoValue:
    """Numbers of the runs that have no value of a quantity and that statistics count all the same, as arrays; of those that values_of()
    may have."""
    moving: np.ndarray  # blocks move
    undecided: np.ndarray  # the search for equilibrium ended without an answer; None if no run of the study is
    beyond: np.ndarray  # a factor of safety is known to be LARGEST_FACTOR or more, and nothing else

    def before(self, end):
        """The same of the runs before this one."""
        return NoValue(*(None if runs is None else runs[runs < end] for runs in (self.moving, self.undecided, self.beyond)))


ALL_HAVE_VALUES = NoValue(np.zeros(0, int), None, np.zeros(0, int))


def no_value(study, rows, at):
    """The NoValue of a quantity."""
    file = file_of(study.quantities[at])

    def runs_that(ended):
        return counted_runs(study, rows, lambda row: row["values"][at] is None and row["no_equilibrium"].get(file) == ended)
    undecided = runs_that(UNDECIDED)
    return NoValue(runs_that(MOVING), undecided if len(undecided) else None, counted_runs(study, rows, lambda row: is_beyond(study, row, at)))


def bracket_width(study, rows, at):
    """The largest width of the brackets that a factor of safety is known by: infinite where a run has no upper end. None for other
    quantities."""
    if study.quantities[at].what != "factor of safety":
        return None
    ends = lower_end(study, at)
    brackets = [row["values"][ends:ends + 2] for row in rows if row["values"][ends] is not None and not is_beyond(study, row, at)]
    return max((math.inf if high is None else high - low for low, high in brackets), default=None)


def crossed_table(study, values, run):
    """Values [network, parameters], nan where there is none, of networks and sets of parameters that have one. None if they are fewer
    than two, or for another design."""
    if study.design.kind != "networks x parameters":
        return None
    full = np.full(study.design.runs, np.nan)
    full[run] = values
    table = full.reshape(study.design.networks, study.design.parameters)
    there = np.isfinite(table)
    table = table[there.any(axis=1)][:, there.any(axis=0)]
    return table if min(table.shape) > 1 else None


def mean_with_interval(study, values, run, coarse=None):
    """Mean, ends of its interval and its standard error, by what the design allows. coarse [value, 2]: as coarse_of()."""
    design = study.design
    if design.kind == "networks x parameters":
        table = crossed_table(study, values, run)
        return intervals.mean_of_crossed(table) if table is not None else (float(np.mean(values)), None, None, None)
    if design.kind == "table":
        return float(np.mean(values)), None, None, None
    if coarse is not None:
        return intervals.mean_by_control(values, coarse[:, 1] - coarse[:, 0])
    if design.replicates > 1:
        return intervals.mean_of_parts(values, run // (design.runs // design.replicates))
    return intervals.mean(values)


def limits_of(quantity):
    """Its limits with their sides: name, test, and what a run without a value counts whose blocks move: None if runs without equilibrium
    are left out."""
    if quantity.what == "failed":
        return [("probability", lambda values: values > 0.5, True)]
    found = []
    for side, limits in (("above", quantity.above), ("below", quantity.below)):
        for limit in limits:
            def hit(values, side=side, limit=limit):
                return values > limit if side == "above" else values < limit
            name = f"probability {side} {limit:g}"
            if quantity.what == "displacement":
                found += [(name + OF_STABLE, hit, None), (name + OR_NONE, hit, True)]
            else:  # without equilibrium, even with the largest strengths, a factor of safety is below all limits
                found.append((name, hit, side == "below" if quantity.what == "factor of safety" else None))
    return found


def share_with_interval(study, hits, run):
    """Share of runs that hit, with the ends of its interval: of independent runs that of Clopper and Pearson, which is too wide
    for a Latin hypercube or a Sobol sequence."""
    if study.design.are_independent():
        return intervals.probability(int(hits.sum()), len(hits))
    table = crossed_table(study, hits.astype(float), run)
    return intervals.probability_of_crossed(table) if table is not None else (float(np.mean(hits)), None, None)


def shares_of_limits(study, quantity, values, run, others):
    """Probabilities of the limits of a quantity: name, number of runs, value, low, high. others: a NoValue."""
    found = []
    for name, hit, of_moving in limits_of(quantity):
        hits = np.append(hit(values), hit(np.full(len(others.beyond), float(LARGEST_FACTOR))))
        of = np.append(run, others.beyond).astype(int)
        if of_moving is not None:
            hits, of = np.append(hits, np.full(len(others.moving), of_moving)), np.append(of, others.moving).astype(int)
        if of_moving is None or others.undecided is None:
            found.append((name, len(of), *share_with_interval(study, hits, of)))
            continue
        of = np.append(of, others.undecided).astype(int)
        for bound, counts in (("at least", False), ("at most", True)):
            of_all = np.append(hits, np.full(len(others.undecided), counts))
            found.append((f"{name}, {bound}", len(of), *share_with_interval(study, of_all, of)))
    return found


def correlation(values, others):
    """Pearson's correlation; None where there is none."""
    return float(np.corrcoef(values, others)[0, 1]) if len(values) > 2 and np.ptp(values) > 0 and np.ptp(others) > 0 else None


def quantile(values, beyond, part):
    """Quantile with its interval, of values and of as many more that are larger than all of them; None what depends on these."""
    largest = np.max(values, initial=0.0)
    larger, much_larger = (intervals.quantile(np.append(values, np.full(beyond, largest + more)), part) for more in (1, 2))
    return [one if one == other else None for one, other in zip(larger, much_larger)]


def finite(value):
    """The value; None, an empty field, if it is infinite."""
    return value if math.isfinite(value) else None


def statistics(study, quantity, values, run, coarse=None, others=ALL_HAVE_VALUES, width=None):
    """Statistics of a quantity: name, number of runs, value, low, high. coarse [value, 2]: as coarse_of(); others: as no_value(); width:
    as bracket_width(). Where all brackets of a factor of safety are the same, its scatter is only known to be less than their width."""
    found, n, beyond = [], len(values), others.beyond
    if quantity.what != "failed" and n > 0:
        *mean, error = mean_with_interval(study, values, run, coarse)
        only_bound = n > 1 and bool(width) and np.ptp(values) == 0
        found += [("mean", n, mean[0], None, None), ("standard error of the mean, less than", n, finite(width), None, None)] if only_bound else \
            [("mean", n, *mean), ("standard error of the mean", n, error, None, None)]
        if coarse is not None:
            found.append(("mean of fine runs alone", n, *intervals.mean(values)[:3]))
            found.append(("fine less coarse", n, *intervals.mean(values - coarse[:, 0])[:3]))
            found.append(("correlation of fine and coarse", n, correlation(values, coarse[:, 0]), None, None))
        deviation = float(np.std(values, ddof=1)) if n > 1 else None
        found.append(("standard deviation, less than", n, finite(width), None, None) if only_bound else
                     ("standard deviation", n, deviation, None, None))
    if quantity.what != "failed":
        for part in QUANTILES:
            value, low, high = quantile(values, len(beyond), part)
            ends = (low, high) if study.design.are_independent() else (None, None)  # order statistics are of independent values
            found.append((f"quantile {part:g}", n + len(beyond), value, *ends))
    return found + shares_of_limits(study, quantity, values, run, others)


def first_of(quantity, study, values, run, coarse, others):
    """The statistics whose convergence is shown: mean, or probability of failure; and the probabilities of limits."""
    found = shares_of_limits(study, quantity, values, run, others)
    if quantity.what == "failed":
        return found
    return [("mean", len(values), *mean_with_interval(study, values, run, coarse)[:3])] + found


def counts_shown(n):
    """Numbers of runs at which convergence is shown, ending with all."""
    if n < FEWEST:
        return [n]
    return sorted({int(round(count)) for count in np.geomspace(FEWEST, n, STEPS)})


def convergence(study, rows, at):
    """Rows (statistic, runs, value, low, high) over a growing number of runs with a value; of networks x parameters over a growing number
    of networks with all sets of parameters. Other designs that are made as a whole have one."""
    quantity = study.quantities[at]
    values, run = values_of(study, rows, at)
    coarse = coarse_of(study, rows, at, run)
    others = no_value(study, rows, at)
    found = []
    if study.design.kind == "networks x parameters" and len(values):
        ends = [run_of * study.design.parameters for run_of in range(FEWEST_NETWORKS, study.design.networks)]
        for last in [*ends[::max(1, -(-len(ends) // STEPS))], study.design.runs]:
            counts = run < last
            if counts.any():
                found += first_of(quantity, study, values[counts], run[counts], None, others.before(last))
        return found
    for count in [] if len(values) == 0 else counts_shown(len(values)) if study.design.kind in EXTENSIBLE else [len(values)]:
        before = others if count == len(values) else others.before(run[count])
        found += first_of(quantity, study, values[:count], run[:count], None if coarse is None else coarse[:count], before)
    return found


def enough(study, rows):
    """Whether what [stop] wants of its quantity is reached."""
    at = [one.name for one in study.quantities].index(study.stop.of)
    quantity, stop = study.quantities[at], study.stop
    values, run = values_of(study, rows, at)
    if len(values) < (FEWEST if study.design.fine_runs else 2):
        return False
    for name, _, value, low, high in first_of(quantity, study, values, run, coarse_of(study, rows, at, run),
                                              no_value(study, rows, at)):
        half = (high - low) / 2
        if name == "mean":
            if stop.half_width and half > stop.half_width:
                return False
            if stop.relative_half_width and half > stop.relative_half_width * abs(value):
                return False
        elif stop.probability_half_width and half > stop.probability_half_width:
            return False
    return True


# --- Shares of the variance -----------------------------------------------------------------------------------------


def numeric_columns(study):
    """Columns of the parameters that are numbers."""
    return [column for column, one in enumerate(study.parameters) if not any(isinstance(value, str) for value in one.values)]


def rank_correlations(study, rows, given, at):
    """Spearman's correlation of each parameter with the quantity; the interval is of Fisher's transformation with the variance
    of Bonett and Wright (2000). Of networks x parameters with the effect of each set of parameters (mean over networks), because runs
    are not independent."""
    values, run = values_of(study, rows, at)
    if study.quantities[at].what == "failed" and min(np.sum(values > 0.5), np.sum(values < 0.5)) < FEWEST_OF_BOTH:
        return []
    table = crossed_table(study, values, run)
    if study.design.kind == "networks x parameters":
        values, run = (intervals.additive(table)[1], sets_of(study, run)) if table is not None else ([], [])
        values = np.round(values, 9 - math.floor(math.log10(np.ptp(values)))) if len(values) and np.ptp(values) > 0 else values  # for ties
    numeric = numeric_columns(study)
    if len(values) < FEWEST or not numeric or np.ptp(values) == 0:
        return []
    inputs = np.array([[given[number]["given"][column] for column in numeric] for number in run], float)
    from scipy import stats  # takes long to load
    ranks = stats.rankdata(values)
    rows = []
    for column, of_parameter in zip(numeric, inputs.T):
        r = correlation(ranks, stats.rankdata(of_parameter))
        if r is None:
            continue
        low = high = None
        if study.design.kind != "table" and abs(r) < 1 - 1e-12:  # at 1 and -1 the transformation is infinite
            half = 1.96 * np.sqrt((1 + r * r / 2) / (len(values) - 3))
            low, high = map(float, np.tanh(np.arctanh(r) + np.array([-half, half])))
        rows.append((study.parameters[column].name, CORRELATION, float(r), low, high))
    return rows


def chance_correlation(study, rows, given):
    """The largest rank correlation, without its sign, of two parameters that vary and for which the study has no [[correlation]]: their
    names, correlation, and number of sets of values. None if there are not two, or fewer than three sets."""
    if study.design.kind in ("sobol indices", "directional sampling", "table"):
        return None
    run = [row["run"] for row in rows if study.design.level(row["run"]) != "fine"]
    if study.design.kind == "networks x parameters":
        run = [one for one in run if one < study.design.parameters]
    numeric = numeric_columns(study)
    if len(run) < 3 or len(numeric) < 2:
        return None
    from scipy import stats  # takes long to load
    columns = [(study.parameters[column].name, stats.rankdata([given[one]["given"][column] for one in run])) for column in numeric]
    wanted = [{one, other} for one, other, _ in study.correlations]
    found = [((name, other), correlation(values, others)) for (name, values), (other, others) in itertools.combinations(columns, 2)
             if {name, other} not in wanted]
    found = [(pair, r) for pair, r in found if r is not None]
    return (*max(found, key=lambda one: abs(one[1])), len(run)) if found else None


def chance_words(found):
    """Lines of the summary about chance_correlation(): what it is, and a warning if it is larger than usual."""
    if found is None:
        return [], []
    (one, other), r, n = found
    if n <= 4:  # three sets can have any order by chance
        return [f"chance correlation   not judged: {n} sets of values only"], []
    bound = 2 / math.sqrt(n)
    warning = (f'warning: by chance "{one}" and "{other}" have a rank correlation of {r:.2f} in {n} sets of values, more than the usual bound '
               f"of 2 / sqrt({n}) = {bound:.2f}: what one of them does can be taken for the other's; more sets, or a Latin hypercube, have less")
    return [f"chance correlation   {r:.2f}, the largest of two parameters ({one}; {other}); usual bound {bound:.2f}"], \
        [warning] * (abs(r) > bound)


def sets_of(study, run):
    """Numbers of the sets of parameters that these runs of networks x parameters have; they are those of the first network's runs."""
    return np.unique(run % study.design.parameters)


def with_parts(of_shares):
    """Shares of the variance (input, measure, ...) in the order for a reader, each with whether it is a part of that of all parameters:
    these parts follow it."""
    main = [row for row in of_shares if row[1] != CORRELATION]
    names = [row[0] for row in main]
    if ALL_PARAMETERS not in names:
        return [(row, False) for row in main]
    last = names.index(ALL_PARAMETERS) + 2  # after it comes the interaction, and then the parts
    return [*((row, False) for row in main[:last - 1]), *((row, True) for row in main[last:]), (main[last - 1], False)]


def linear_parts(effects, inputs):
    """Of effects that depend on inputs [effect, input]: the part of their variance that each input explains linearly, and the rest. They
    add up to 1. Inputs are independent, so the part of each is in proportion to its squared standardized regression coefficient; all
    of them together have the adjusted coefficient of determination."""
    n, count = inputs.shape
    inputs = inputs - inputs.mean(axis=0)
    effects = effects - effects.mean()
    slopes = np.linalg.lstsq(inputs, effects, rcond=1e-9)[0]
    left = ((effects - inputs @ slopes) ** 2).sum() / (n - 1 - count)
    explained = max(0.0, 1 - left / ((effects**2).sum() / (n - 1)))
    parts = slopes**2 * (inputs**2).sum(axis=0)
    parts = parts / parts.sum() * explained if parts.sum() > 0 else np.zeros(count)
    return np.append(parts, 1 - parts.sum())


def crossed_shares(study, rows, given, at):
    """Shares of the networks, of the parameters, and of both together beside that, in the variance; that of the parameters is also
    divided among them, if they are independent and several, and there are enough sets. Intervals by 1000 tables drawn from the networks
    and the sets of parameters (bootstrap of both)."""
    values, run = values_of(study, rows, at)
    table = crossed_table(study, values, run)
    if table is None or np.ptp(values) == 0 or intervals.components(table) is None:
        return []
    numeric, sets = numeric_columns(study), sets_of(study, run)
    divided = len(study.parameters) > 1 and not study.correlations and numeric and len(sets) >= max(FEWEST, SETS_EACH * len(numeric))
    inputs = np.array([[given[one]["given"][column] for column in numeric] for one in sets], float) if divided else None

    def shares(networks, of_sets):
        of = table[networks][:, of_sets]
        there = np.isfinite(of)
        full_rows, full_columns = there.any(axis=1), there.any(axis=0)
        of, of_sets = of[full_rows][:, full_columns], of_sets[full_columns]
        found = intervals.components(of) if min(of.shape) > 1 else None
        if found is None:
            return None
        parts = np.maximum(0.0, found)
        parts = parts / parts.sum() if parts.sum() > 0 else parts
        if not divided:
            return parts
        effects = intervals.additive(of)[1]
        return np.append(parts, parts[1] * linear_parts(effects, inputs[of_sets])) if np.ptp(effects) > 0 and \
            len(of_sets) > len(numeric) + 1 else np.append(parts, np.zeros(len(numeric) + 1))

    random = np.random.Generator(np.random.Philox(study.design.seed))
    drawn = (shares(*(random.integers(0, count, count) for count in table.shape)) for _ in range(1000))
    low, high = np.quantile([one for one in drawn if one is not None], [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2], axis=0)
    names = [NETWORK, ALL_PARAMETERS, f"{NETWORK} with parameters"]
    if divided:
        names += [study.parameters[column].name for column in numeric] + [NOT_LINEAR]
    # A share is not negative, so those drawn of a share near 0 can all be larger than it.
    return [(name, "share of variance", float(share), min(float(of_low), float(share)), max(float(of_high), float(share)))
            for name, share, of_low, of_high in zip(names, shares(*map(np.arange, table.shape)), low, high)]


@calls_openturns
def sobol_indices(study, rows, at):
    """First-order and total Sobol indices by Martinez's estimator, with its asymptotic intervals. Points of the design are left
    out where one of their runs has no value."""
    ot = openturns()
    points = study.design.points
    names = [one.name for one in study.parameters] + ([NETWORK] if study.varies_network else [])
    value = {row["run"]: value_of(study, row, at) for row in rows}
    parts = len(names) + 2
    kept = [point for point in range(points) if all(value.get(point + part * points) is not None for part in range(parts))]
    outputs = np.array([value[point + part * points] for part in range(parts) for point in kept], float)
    if len(kept) < FEWEST or np.ptp(outputs) == 0:
        return []
    inputs = ot.Sample(len(outputs), len(names))  # of the right size: the estimator needs no values of inputs
    found = ot.MartinezSensitivityAlgorithm(inputs, ot.Sample(outputs[:, None].tolist()), len(kept))
    found.setUseAsymptoticDistribution(True)
    found.setConfidenceLevel(CONFIDENCE)
    rows = []
    for measure, indices, interval in (("first order index", found.getFirstOrderIndices(), found.getFirstOrderIndicesInterval()),
                                       ("total index", found.getTotalOrderIndices(), found.getTotalOrderIndicesInterval())):
        low, high = interval.getLowerBound(), interval.getUpperBound()
        rows += [(name, measure, indices[row], low[row], high[row]) for row, name in enumerate(names)]
    return rows


def shares(study, rows, given, at):
    """Rows (input, measure, value, low, high) of a quantity."""
    if not study.parameters:
        return []
    if study.design.kind == "sobol indices":
        return sobol_indices(study, rows, at)
    if study.design.kind == "networks x parameters":
        return crossed_shares(study, rows, given, at) + rank_correlations(study, rows, given, at)
    return rank_correlations(study, rows, given, at)


def level_costs(study, rows):
    """What two levels cost, as rows: quantity, processor seconds of a fine and of a coarse run, their correlation, the number of coarse
    runs for each fine one that is cheapest (Pasupathy and others 2012), and the time of this study over that of plain sampling by fine
    runs for as narrow an interval."""
    of_levels = [[row["processor_seconds"] for row in rows if study.design.level(row["run"]) == level] for level in ("fine", "coarse")]
    if not all(of_levels):
        return []
    seconds, found = [float(np.mean(one)) for one in of_levels], []
    for at, quantity in enumerate(study.quantities):
        values, run = values_of(study, rows, at)
        coarse = coarse_of(study, rows, at, run)
        r = correlation(values, coarse[:, 0])
        error = mean_with_interval(study, values, run, coarse)[3]
        if quantity.what == "failed" or r is None or not error or r * r == 1:
            continue
        cheapest = max(2, round(math.sqrt(r * r / (1 - r * r) * seconds[0] / seconds[1])))
        plain = float(np.var(values, ddof=1)) / error**2 * seconds[0]
        mine = len(values) * (seconds[0] + study.design.coarse_per_fine * seconds[1])
        found.append((quantity.name, *seconds, r, cheapest, mine / plain))
    return found


# --- Files ----------------------------------------------------------------------------------------------------------


def number_text(value):
    return "" if value is None else f"{value:.4g}"


def in_columns(rows):
    """Lines of text with aligned columns."""
    widths = [max(map(len, column)) for column in zip(*rows)]
    return ["  ".join(cell.ljust(width) if place == 0 else cell.rjust(width)
                      for place, (cell, width) in enumerate(zip(row, widths))).rstrip() for row in rows]


def failure_place(row):
    """ 'stage "bench", 2 moving blocks, 0.31 m2: ' of a run without equilibrium; "" if it is not known."""
    failure = row.get("failure")
    if not failure:
        return ""
    stage, day, count = failure["stage"], failure["day"], failure["blocks"]
    when = f'stage "{stage}"' if stage else f"day {files.day_text(day)}" if day else "before the first stage"
    if not count:
        return f"{when}: "
    blocks = "block" if count == 1 else "blocks"
    what = f"moving {blocks}" if ending_of(row) == MOVING else f"{blocks} that moved most"
    return f"{when}, {count} {what}, {failure['area']:.4g} m2: "


def failure_words(row):
    """A short line on a run that failed."""
    reason = row["reason"].partition(";")[0].removeprefix(f"{row['program']}: ")
    reason = re.sub(r"(after \d+ steps) the unbalanced force ratio is .*? and (by estimate .*? of displacement remain).*", r"\1 \2",
                    reason)
    code = "" if row["exit_code"] == NO_EQUILIBRIUM else f"exit code {row['exit_code']}: "
    what = UNDECIDED if ending_of(row) == UNDECIDED else "failed"
    return f"run {row['run']} {what}: {failure_place(row)}{row['program']}: {code}{textwrap.shorten(reason, SHORT, placeholder=' ...')}".removesuffix(": ")


def missing_words(study, rows):
    """Which runs have no value, and why."""
    lines = [failure_words(row) for row in rows if row["exit_code"] != 0]
    if len(lines) > NAMED:
        lines[NAMED:] = [f"and {len(lines) - NAMED} more in runs.csv"]
    for at, one in enumerate(study.quantities):
        beyond = [row["run"] for row in rows if is_beyond(study, row, at)]
        if beyond:
            lines.append(f"{one.title()}: at least {LARGEST_FACTOR}, the largest factor that is tried, in {len(beyond)} of {len(rows)} runs: "
                         f"{files.listed(beyond)}; they are not in mean and deviation, and count as larger in quantiles and probabilities")
        runs = [row["run"] for row in rows if row["values"][at] is None and row["exit_code"] == 0 and not is_beyond(study, row, at)]
        if runs and one.what == "displacement":
            lines.append(f'{one.title()}: an excavation takes the point "{one.point}" before, or it is not read yet, in '
                         f"{len(runs)} of {len(rows)} runs: {files.listed(runs)}")
        elif runs:
            lines.append(f"{one.title()}: no value in {len(runs)} of {len(rows)} runs: {files.listed(runs)}")
    return lines


def incomplete_words(study, rows):
    """Warnings of the quantities of networks x parameters that some runs of a network have and others do not."""
    lines = []
    for at, one in enumerate(study.quantities if study.design.kind == "networks x parameters" else []):
        of_network = collections.Counter(row["run"] // study.design.parameters for row in rows
                                         if row["values"][at] is None and not is_beyond(study, row, at))
        if of_network:
            lines.append(f"warning: {one.title()}: {sum(of_network.values())} of {len(rows)} runs, of {len(of_network)} networks, have no "
                         "value; answers are of the other runs")
    return lines


def strength_factors(study):
    """What strengths are divided by in all runs, as written; none if they are as in the scene."""
    options = [*study.demsolve_options, *study.design.fine_options, *study.design.coarse_options]
    factors = [options[place + 1] for place, one in enumerate(options[:-1]) if one == "--strength-factor"] + \
        [one.partition("=")[2] for one in options if one.startswith("--strength-factor=")]
    return [factor for factor in dict.fromkeys(factors) if not is_one(factor)]


def is_one(text):
    try:
        return float(text) == 1
    except ValueError:  # demsolve says it
        return False


def early_words(study, rows, why):
    """A warning of answers that runs are missing from."""
    if why in ("", BY_STOP_RULE) or study.design.directions:
        return []
    if not rows:
        return ["warning: run 0 has not ended, so there are no answers: they are of the runs from 0 on without a gap. Runs that take long are "
                "often near failure. The same command continues; with --finish the answers are of all runs that have ended"]
    return [f"warning: the answers are of {len(rows)} of {study.design.runs} runs. Runs that take long may be missing more often than others"]


def undecided_words(study, rows):
    """A warning of runs that ended undecided, which says how they are counted."""
    count = sum(ending_of(row) == UNDECIDED for row in rows)
    if not count:
        return []
    how = "count as failed" if study.design.directions else \
        'have no value; probabilities that depend on them have a row "at least", in which none of them counts, and a row "at most", ' \
        "in which all of them do"
    return [f"warning: {count} of {len(rows)} runs ended undecided: whether they have an equilibrium is not known. They {how}. More "
            'most_steps of [equilibrium] can decide them (with engine = "implicit": engine = "auto")']


def reduced_words(study):
    """A warning of displacements that are those of runs with reduced strengths."""
    factors = strength_factors(study)
    if not factors or all(one.what != "displacement" for one in study.quantities):
        return []
    return [f"warning: all strengths are divided by {', '.join(factors)} (--strength-factor), so the displacements are not "
            "those of the rock; collect them in a study without this option"]


def warning_words(rows):
    """The warnings of the programs, with the number of runs that have each; numbers in a warning are those of the first such run."""
    texts, count = {}, collections.Counter()
    for row in rows:
        kinds = {re.sub(r'(?<![\w."])-?\d+(\.\d+)?(e[+-]?\d+)?', "#", text): text for text in row.get("warnings", [])}
        count.update(kinds.keys())
        texts = {**kinds, **texts}
    return [f"warning in {number} of {len(rows)} runs: {texts[kind]}" for kind, number in count.most_common()]


def with_unit(name, quantity):
    """The name of a statistic, where it has a limit with the unit of this; that of a failure says what it is the probability of."""
    if quantity.what == "failed":
        return name.replace("probability", TO_FAIL, 1)
    return name if quantity.unit == "1" else re.sub(r"^(probability (?:above|below) [^ ,]+)", rf"\1 {quantity.unit}", name)


def summary(study, rows, why, of_each, of_histories, of_chance=None):
    """What a person reads first. of_chance: as chance_correlation()."""
    chance, too_large = chance_words(of_chance)
    without = [row for row in rows if row["exit_code"] == NO_EQUILIBRIUM]
    other = sum(row["exit_code"] not in (0, NO_EQUILIBRIUM) for row in rows)
    lines = [study.title] * bool(study.title)
    of_all = "" if study.design.directions else f" of {study.design.runs}"
    factors = strength_factors(study)
    lines += [f"strengths            divided by {', '.join(factors)} (--strength-factor)"] * bool(factors)
    lines += [f"design               {study.design.kind}",
              f"runs                 {len(rows)}" + (f"{of_all}, ended {why}" if why else ""),
              f"without equilibrium  {len(without)}"]
    lines += [f"  {what:17}  {sum(ending_of(row) == what for row in without)}" for what in (MOVING, UNDECIDED) if without]
    lines += [f"other failures       {other}", *chance]
    for quantity, found, of_shares in of_each:
        lines += ["", f"{quantity.title()}, {found.get('values', found['statistics'][0][1])} {study.design.counted()} with a value" +
                  (f", and {found['beyond']} at least {LARGEST_FACTOR}" if found.get("beyond") else "")]
        lines += in_columns([["", study.design.counted(), "value", "from", "to"],
                             *([with_unit(name, quantity), str(n), *map(number_text, numbers)] for name, n, *numbers in found["statistics"])])
        if of_shares:
            lines += in_columns([["", "value", "from", "to"],
                                 *([f"  of these, {name}" if is_part else f"{measure}, {name}", *map(number_text, numbers)]
                                   for (name, measure, *numbers), is_part in with_parts(of_shares)),
                                 *([f"{measure}, {name}", *map(number_text, numbers)]
                                   for name, measure, *numbers in of_shares if measure == CORRELATION)])
    lines += ["", f"from, to: {CONFIDENCE:.0%} confidence interval; empty where the runs are too few or the design has none"]
    lines += [""] * bool(of_histories) + of_histories
    notes = too_large + early_words(study, rows, why) + undecided_words(study, rows) + reduced_words(study) + warning_words(rows)
    if not study.design.directions:
        notes = incomplete_words(study, rows) + notes + missing_words(study, rows)
    return "\n".join(lines + [""] * bool(notes) + notes) + "\n"


def of_failure(study, rows, estimates):
    """Quantity, statistics and no shares of a directional sampling: runs are along directions, so nothing else is known of them."""
    (quantity,) = (one for one in study.quantities if one.name == study.design.failure)
    statistics = [("probability of failure", len(rows), *failure.probability(np.array(estimates)))]
    return quantity, {"at": study.quantities.index(quantity), "statistics": statistics}, []


def write(study, rows, given, why, estimates, of_histories, out):
    """Writes answers.csv, convergence.csv, shares.csv and summary.txt. Returns of each quantity with values: quantity, its place,
    statistics, shares. `of_histories` are lines that the summary says of histories; `estimates` are those of the replicates of a
    directional sampling."""
    found = []
    by_direction = study.design.directions > 0
    if by_direction and len(estimates) > 1:
        found.append(of_failure(study, rows, estimates))
    for at, quantity in enumerate([] if by_direction else study.quantities):
        values, run = values_of(study, rows, at)
        others = no_value(study, rows, at)
        if len(values) or len(others.beyond):
            of = statistics(study, quantity, values, run, coarse_of(study, rows, at, run), others, bracket_width(study, rows, at))
            found.append((quantity, {"at": at, "statistics": of, "beyond": len(others.beyond), "values": len(values)}, shares(study, rows, given, at)))
    files.write_text(out / "answers.csv", files.csv_text(
        ["quantity", "unit", "statistic", "runs", "value", "low", "high"],
        [(one.label(), one.unit, *row) for one, of, _ in found for row in of["statistics"]]))
    files.write_text(out / "convergence.csv", files.csv_text(
        ["quantity", "unit", "statistic", "runs", "value", "low", "high"],
        [(one.label(), one.unit, *row) for one, of, _ in found if not by_direction for row in convergence(study, rows, of["at"])]))
    files.write_text(out / "shares.csv", files.csv_text(
        ["quantity", "input", "measure", "value", "low", "high"],
        [(one.label(), *row) for one, _, of_shares in found for row in of_shares]))
    files.write_text(out / "summary.txt", summary(study, rows, why, found, of_histories, chance_correlation(study, rows, given)))
    return found


def write_costs(study, rows, out):
    """Writes costs.csv of two levels, which depends on the machine. Returns what it says, as lines."""
    found = level_costs(study, rows)
    heads = ["quantity", "fine_seconds", "coarse_seconds", "correlation", "cheapest_coarse_per_fine", "time_over_plain"]
    files.write_text(out / "costs.csv", files.csv_text(heads, [
        [name, *(f"{one:.3f}" for one in seconds), f"{r:.5f}", cheapest, f"{times:.3f}"] for name, *seconds, r, cheapest, times in found]))
    return [f"\n{name}: a fine run takes {fine:.2f} s of the processor, a coarse one {coarse:.2f} s; the cheapest coarse_per_fine is "
            f"{cheapest}.\nThis study took {times:.2f} of the time of plain sampling by fine runs for as narrow an interval.\n"
            for name, fine, coarse, _, cheapest, times in found]
