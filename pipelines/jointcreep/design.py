"""What each run is given: the number of its network, and a value for each parameter.

Points are drawn in the unit cube and then mapped to the laws, so that all designs have the same laws. OpenTURNS draws and maps; where all
parameters have lists of values, numpy draws, except for designs with Sobol sequences or indices.
A plain design of more runs begins with the runs of a smaller one.
"""

import functools
import math
import signal
import threading

import numpy as np

from .errors import NotWanted

FLAT = 1e-12  # how near to 0 and 1 a point of the unit cube may be


@functools.cache
def openturns():
    """The library, which a study without laws does without."""
    try:
        import openturns
    except ImportError as error:
        raise NotWanted(f"Python's module openturns cannot be loaded ({error}). It draws [[vary]] with a law, and the designs sobol sequence and "
                        "sobol indices. First run: apt install python3-openturns (in the sources: sh pipelines/setup.sh studies). Without it "
                        "give [[vary]] values in place of a law: 100 quantiles of the law, at the probabilities 0.005, 0.015, ... 0.995") from None
    openturns.Log.Show(openturns.Log.NONE)
    return openturns


def hear_interrupts():
    """Puts Python's handler of SIGINT back. Calls of OpenTURNS put one in its place that aborts the program."""
    handler = signal.getsignal(signal.SIGINT)
    if handler is not None and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, handler)


def calls_openturns(function):
    """A decorator: Ctrl-C stops the program after the function as before it."""
    @functools.wraps(function)
    def called(*arguments):
        try:
            return function(*arguments)
        finally:
            hear_interrupts()

    return called


def draws_with_numpy(study):
    """Whether points are drawn without OpenTURNS: no parameter has a law."""
    return not any(one.law for one in study.parameters) and study.design.kind not in ("sobol sequence", "sobol indices")


def numpy_points(design, dimension):
    """Points in the unit cube [run, dimension] of a design without Sobol sequences, by numpy."""
    random = np.random.Generator(np.random.Philox(design.seed))
    if design.kind == "latin hypercube":
        size = design.runs // design.replicates
        return np.concatenate([np.column_stack([(random.permutation(size) + random.random(size)) / size for _ in range(dimension)])
                               for _ in range(design.replicates)])
    size = design.parameters if design.kind == "networks x parameters" else design.networks_drawn()
    return random.random((size, dimension))


def cube_points(design, dimension):
    """Points in the unit cube [run, dimension]."""
    ot = openturns()
    ot.RandomGenerator.SetSeed(design.seed)
    if design.fine_runs or design.kind == "plain":
        size = design.networks_drawn()
        return np.array(ot.RandomGenerator.Generate(size * dimension)).reshape(size, dimension)
    if design.kind == "networks x parameters":
        return np.array(ot.RandomGenerator.Generate(design.parameters * dimension)).reshape(design.parameters, dimension)
    cube = ot.ComposedDistribution([ot.Uniform(0, 1)] * dimension)
    if design.kind == "sobol indices":
        return np.array(ot.SobolIndicesExperiment(cube, design.points, False).generate())
    size = design.runs // design.replicates
    if design.kind == "latin hypercube":
        parts = [ot.LHSExperiment(cube, size).generate() for _ in range(design.replicates)]
    else:
        experiment = ot.LowDiscrepancyExperiment(ot.SobolSequence(), cube, size, True)
        experiment.setRandomize(True)  # a random shift for each replicate (Cranley and Patterson)
        parts = [experiment.generate() for _ in range(design.replicates)]
    return np.concatenate([np.array(part) for part in parts])


def law_of(parameter):
    """A parameter's law in OpenTURNS."""
    ot = openturns()
    values = parameter.constants
    if parameter.law == "normal":
        law = ot.Normal(values["mean"], values["deviation"])
    elif parameter.law == "lognormal":
        law = ot.ParametrizedDistribution(ot.LogNormalMuSigma(values["mean"], values["deviation"], 0.0))
    elif parameter.law == "uniform":
        law = ot.Uniform(values["lowest"], values["highest"])
    else:
        law = ot.Triangular(values["lowest"], values["most_likely"], values["highest"])
    low, high = (math.isfinite(end) for end in (parameter.lowest, parameter.highest))
    if low or high:
        share = law.computeCDF(parameter.highest) if high else 1.0
        if share - (law.computeCDF(parameter.lowest) if low else 0.0) < 1e-6:
            raise NotWanted(f"{parameter.place}lowest and highest leave less than 1e-6 of the law; expected a wider range")
        if low and high:
            law = ot.TruncatedDistribution(law, parameter.lowest, parameter.highest)
        elif low:
            law = ot.TruncatedDistribution(law, parameter.lowest, ot.TruncatedDistribution.LOWER)
        else:
            law = ot.TruncatedDistribution(law, parameter.highest, ot.TruncatedDistribution.UPPER)
    return law


def joint_law(study):
    """The law of all parameters that have one; correlations are of ranks (Spearman), by a normal copula."""
    ot = openturns()
    varying = [one for one in study.parameters if one.law]
    laws = [law_of(one) for one in varying]
    names = [one.name for one in varying]
    ranks = ot.CorrelationMatrix(len(laws))
    for one, other, coefficient in study.correlations:
        ranks[names.index(one), names.index(other)] = coefficient
    try:
        copula = ot.NormalCopula(ot.NormalCopula.GetCorrelationFromSpearmanCorrelation(ranks))
    except (TypeError, RuntimeError):
        raise NotWanted(f"{study.path}: the correlations contradict each other: their matrix is not positive definite") from None
    return ot.ComposedDistribution(laws, copula if study.correlations else ot.IndependentCopula(len(laws)))


def mapped(study, points):
    """Values of the parameters with a law [run, law], from points in the unit cube."""
    normal = openturns().Normal()
    standard = [[normal.computeQuantile(float(part))[0] for part in point] for point in points]
    return np.array(joint_law(study).getInverseIsoProbabilisticTransformation()(standard))


@calls_openturns
def draw(study):
    """Networks [run] and values of the parameters, a list of lists [run][parameter]."""
    design, size = study.design, study.design.networks_drawn()
    pairs = design.kind == "networks x parameters"
    in_cube = design.kind == "sobol indices" and study.varies_network  # the network is its last dimension
    if design.kind == "table":
        return np.array(design.networks_given), [[one.values[run] for one in study.parameters] for run in range(design.runs)]
    if not study.parameters:
        return by_run(study, np.arange(size), [[] for _ in range(size)])
    drawn = numpy_points if draws_with_numpy(study) else cube_points
    points = np.clip(drawn(design, len(study.parameters) + in_cube), FLAT, 1 - FLAT)
    with_law = [row for row, one in enumerate(study.parameters) if one.law]
    columns = [None] * len(study.parameters)
    if with_law:
        values = mapped(study, points[:, with_law])
        for column, row in enumerate(with_law):
            columns[row] = values[:, column].tolist()
    for row, one in enumerate(study.parameters):
        if not one.law:
            columns[row] = [one.values[int(part * len(one.values))] for part in points[:, row]]
    rows = [list(row) for row in zip(*columns)]
    if pairs:
        return np.repeat(np.arange(design.networks), design.parameters), rows * design.networks
    if not study.varies_network:
        return by_run(study, np.zeros(size, int), rows)
    if in_cube:  # each point of the cube has a network of its own; runs that share the point share the network
        return np.unique(points[:, -1], return_inverse=True)[1], rows
    return by_run(study, np.arange(size), rows)


def by_run(study, networks, rows):
    """Networks and parameters of each run, where those that are drawn are of several runs each."""
    if not study.design.fine_runs:
        return networks, rows
    places = [study.design.network_place(run) for run in range(study.design.runs)]
    return networks[places], [rows[place] for place in places]
