"""The probability of a rare failure by directional sampling, conditioned on a network.

In the space of standard normal variables a direction is drawn from the middle of all laws, and followed until runs fail. The share of
that direction is the probability to be farther out (Ditlevsen and Bjerager 1988). Directional sampling of OpenTURNS draws and counts; it
asks for one run after another, so that a replicate is one group. Replicates are independent, each with a network of its own if the network
varies: the probability is their mean.
"""

from . import design, intervals
from .errors import NotWanted
from .quantities import NO_EQUILIBRIUM

FARTHEST = 8.0  # distance from the middle at which a direction ends; beyond are 1e-15 to 1e-11 of one to five laws
PRECISION = 1e-4  # of the distance at which runs begin to fail
MOST_HALVINGS = 60


def fails(study, row):
    """Whether a run has failed: it has no equilibrium, or the quantity of [design] failure is beyond its limit."""
    at = [one.name for one in study.quantities].index(study.design.failure)
    quantity, value = study.quantities[at], row["values"][at]
    if row["exit_code"] == NO_EQUILIBRIUM:
        return True
    if value is None:
        raise NotWanted(f"run {row['run']} has no value of \"{quantity.name}\": {row['reason'] or 'its point is gone'}")
    if quantity.what == "failed":
        return value > 0.5
    return any(value > limit for limit in quantity.above) or any(value < limit for limit in quantity.below)


@design.calls_openturns
def estimate(study, replicate, run):
    """Probability of failure given the network of a replicate. run(values) makes a run with values of the parameters and returns its
    line of results."""
    ot = design.openturns()
    ot.RandomGenerator.SetSeed((study.design.seed + 7919 * replicate) % 2**32)
    joint = design.joint_law(study)
    dimension = joint.getDimension()

    def standing(values):
        design.hear_interrupts()
        return [-1.0 if fails(study, run(list(values))) else 1.0]

    event = ot.ThresholdEvent(ot.CompositeRandomVector(ot.PythonFunction(dimension, 1, standing), ot.RandomVector(joint)), ot.Less(), 0.0)
    root = ot.RiskyAndFast(ot.Bisection(PRECISION, 0.0, 0.0, MOST_HALVINGS))
    root.setMaximumDistance(FARTHEST)
    directions = ot.OrthogonalDirection(dimension, 1) if dimension > 1 else ot.RandomDirection(1)
    sampling = ot.DirectionalSampling(event, root, directions)
    sampling.setBlockSize(1)
    sampling.setMaximumOuterSampling(-(-study.design.directions // (2 * dimension)))
    sampling.setMaximumCoefficientOfVariation(0.0)  # it ends with the number of directions alone
    sampling.setMaximumStandardDeviation(0.0)
    sampling.run()
    return float(sampling.getResult().getProbabilityEstimate())


def probability(estimates):
    """Mean of the replicates' estimates, and ends of Student's interval, not below 0."""
    value, low, high, _ = intervals.mean(estimates)
    return value, max(0.0, low), high
