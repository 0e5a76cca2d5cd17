"""Laws of orientation: the angle of traces in the section, and Fisher's law of poles in space.

Traces are weighed by one over their chance to be seen in the window; poles, by Terzaghi, by one over the chance of their plane to be met by a
scanline (|n.v|, v along it) or by the plane of a section (|n_p|, the part of the pole in it). So the laws are those of all joints.
"""

import csv
import dataclasses
import math

import numpy as np
from scipy import stats

from .errors import NotWanted

BLIND = math.sin(math.radians(10))  # planes nearer to the scanline or section count as if they were just that near
LEAST_CONCENTRATION = 5  # that a scene takes


@dataclasses.dataclass(frozen=True)
class Normal:
    """A normal law of the angle of traces [deg], with 95 percent intervals."""

    mean: float
    mean_interval: tuple
    deviation: float
    deviation_interval: tuple


def trace_angle(seen, chance):
    """The law of the traces' angles; `chance` is in proportion to what each had to be seen."""
    weight = 1 / chance
    weight /= weight.sum()
    double = np.radians(2 * seen.angle)
    mean = math.degrees(math.atan2((weight * np.sin(double)).sum(), (weight * np.cos(double)).sum())) / 2
    off = (seen.angle - mean + 90) % 180 - 90
    mean += (weight * off).sum()
    off = (seen.angle - mean + 90) % 180 - 90
    number = 1 / (weight**2).sum()  # of traces of equal weight that say as much
    deviation = math.sqrt((weight * off**2).sum() * number / (number - 1))
    half = stats.t.ppf(0.975, number - 1) * deviation / math.sqrt(number)
    low, high = (deviation * math.sqrt((number - 1) / stats.chi2.ppf(p, number - 1)) for p in (0.975, 0.025))
    return Normal(mean, (mean - half, mean + half), deviation, (low, high))


@dataclasses.dataclass(frozen=True)
class Fisher:
    """Fisher's law of poles: mean plane [deg], the cone that holds its pole with 95 percent [deg], concentration."""

    dip: float
    dip_direction: float
    cone: float
    concentration: float
    concentration_interval: tuple
    number: int


def read_poles(path):
    """Normals {east, north, up}, upward, and weights of a file with the columns dip_deg, dip_direction_deg and, if wanted, weight."""
    with open(path, newline="", encoding="utf-8-sig") as file:
        rows = list(csv.DictReader((line for line in file if line.strip() and not line.startswith("#")), skipinitialspace=True))
    if not rows or not {"dip_deg", "dip_direction_deg"} <= set(rows[0]):
        raise NotWanted(f"{path}: expected the columns dip_deg, dip_direction_deg and, if wanted, weight")
    try:
        values = np.array([[float(row["dip_deg"]), float(row["dip_direction_deg"]), float(row.get("weight") or 1)] for row in rows])
    except (TypeError, ValueError):
        raise NotWanted(f"{path}: not every dip_deg, dip_direction_deg and weight is a number") from None
    dip, direction, weight = values.T
    if not (np.isfinite(values).all() and (dip >= 0).all() and (dip <= 90).all() and (abs(direction) <= 360).all() and
            (weight > 0).all()):
        raise NotWanted(f"{path}: expected dips from 0 to 90 degrees, dip directions to 360 degrees, weights above 0")
    dip, direction = np.radians(dip), np.radians(direction)
    return np.column_stack([np.sin(dip) * np.sin(direction), np.sin(dip) * np.cos(direction), np.cos(dip)]), weight


def met_by_scanline(normals, trend, plunge):
    """The chance of each plane to be met by a scanline [deg], in proportion."""
    trend, plunge = math.radians(trend), math.radians(plunge)
    along = np.array([math.cos(plunge) * math.sin(trend), math.cos(plunge) * math.cos(trend), -math.sin(plunge)])
    return np.maximum(np.abs(normals @ along), BLIND)


def met_by_section(normals, azimuth):
    """The same of a vertical section whose x axis has that bearing [deg]."""
    across = np.array([math.cos(math.radians(azimuth)), -math.sin(math.radians(azimuth)), 0.0])
    return np.maximum(np.sqrt(np.maximum(0, 1 - (normals @ across) ** 2)), BLIND)


def fisher(normals, weight, what):
    """Fisher's law (Fisher, Lewis, Embleton 1987, sections 4.4 and 5.3), `weight` in place of counts."""
    weight = weight / weight.sum()
    number = 1 / (weight**2).sum()
    if number < 5:
        raise NotWanted(f"{what}: {len(weight)} poles count as {number:.1f} of equal weight; expected 5 or more")
    axis = np.linalg.eigh((normals * weight[:, None]).T @ normals)[1][:, -1]
    axis *= 1 if axis[2] >= 0 else -1
    normals = normals * np.where(normals @ axis < 0, -1, 1)[:, None]
    mean = (normals * weight[:, None]).sum(axis=0)
    length = np.linalg.norm(mean)
    mean = mean / length * (1 if mean[2] >= 0 else -1)
    off = number * (1 - length)
    concentration = (number - 1) / off if off > 0 else math.inf
    if not LEAST_CONCENTRATION <= concentration <= 1e6:
        raise NotWanted(f"{what}: the poles have a concentration of {concentration:.3g}; a scene takes one from {LEAST_CONCENTRATION} to "
                        "1e6. Divide them into sets, or take the law bootstrap")
    interval = tuple(stats.chi2.ppf(p, 2 * (number - 1)) / (2 * off) for p in (0.025, 0.975))
    cosine = 1 - off / (number * length) * (20 ** (1 / (number - 1)) - 1)
    return Fisher(math.degrees(math.acos(min(1.0, mean[2]))), math.degrees(math.atan2(mean[0], mean[1])) % 360,
                  math.degrees(math.acos(max(-1.0, cosine))), concentration, interval, len(weight))
