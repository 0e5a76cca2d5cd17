"""Two pillars under a rigid level cap: the published creep step beside the fitted one, at equally many equilibria.

A state-space version of data/verification/two-pillars, without zones: joints F_i = K_i (w - d_i) of equal area under
the weight  F_1 + F_2 = W, put on at T = 0. It shows the error of a scheme alone, also where demsolve refuses the
published step, and how much the error depends on the pair of joints.
"""

from dataclasses import dataclass

import numpy as np

import closed_forms

RATIOS = [1, 1.44, 5, 20]  # K/E
STEPS, SPAN = 8, 1.0  # equal steps over lam T = 1


@dataclass
class Pillars:
    stiffness: np.ndarray  # K of the two
    kelvin_stiffness: np.ndarray  # E
    rate: np.ndarray  # lam

    @property
    def viscosity(self):
        return self.kelvin_stiffness / self.rate


def stated_pair(ratio):
    """(K, E) and (2 K, 4 E), with the same lam: the simplest one that relaxes at two rates."""
    return Pillars(np.array([1.0, 2.0]), np.array([1.0, 4.0]) / ratio, np.array([1.0, 1.0]))


def scene_pair(ratio):
    """That of the scene: a stiff pillar that creeps much, a soft one that creeps little, at half the rate."""
    return Pillars(np.array([1.0, 0.8]), np.array([1.0, 4.0]) / ratio, np.array([1.0, 0.5]))


def random_pair(ratio, random):
    """K within 10 times of each other; the larger K/E is the ratio, the other down to a quarter, and so with lam."""
    k = 10 ** random.uniform(0, 1, 2)
    softer, rate = (np.array([1.0, 4 ** -random.uniform()]) for _ in range(2))
    return Pillars(k, k / (ratio * softer), rate if random.uniform() < 0.5 else rate[::-1])


def weights(scheme, pillars, step):
    """a, c_0, c_1 of  d <- a d + c_0 F_0 + c_1 F_1  (docs/method.md, section 8)."""
    x = pillars.rate * step
    ratio = pillars.stiffness / pillars.kelvin_stiffness
    whole = -np.expm1(-x)
    if scheme == "published":
        last = np.zeros(2)
    else:
        between_walls = np.exp(-x * (1 + ratio))
        last = (whole - (np.exp(-x) - between_walls) / ratio) / -np.expm1(-x * (1 + ratio))
    return np.exp(-x), (whole - last) / pillars.kelvin_stiffness, last / pillars.kelvin_stiffness


def largest_error(pillars, scheme, steps):
    """Of a force, over the run, over the weight."""
    step = SPAN / steps
    decay, first, last = weights(scheme, pillars, step)
    k = pillars.stiffness
    d = np.zeros(2)
    force = k / k.sum()
    worst = 0.0
    for n in range(1, steps + 1):
        offset = decay * d + first * force
        acting = 1 / (1 / k + last)  # F = acting (w - offset)
        force = acting * ((1 + acting @ offset) / acting.sum() - offset)
        d = offset + last * force
        exact, _ = closed_forms.shares(k, pillars.kelvin_stiffness, pillars.viscosity, 1.0, n * step)
        worst = max(worst, np.abs(force - exact).max())
    return worst


def gain(pillars, steps=STEPS):
    """How many times smaller the fitted step's largest force error is."""
    return largest_error(pillars, "published", steps) / largest_error(pillars, "fitted", steps)


def growth(pillars, step):
    """By how much the published step multiplies the force that grows most, or decays least."""
    decay, first, _ = weights("published", pillars, step)
    k = pillars.stiffness
    held = np.outer(k, k) / k.sum() - np.diag(k)  # F = F_0 + held d
    return np.abs(np.linalg.eigvals(np.diag(decay) + first[:, None] * held)).max()


def rows():
    """[K/E, gains of the stated pair and the scene's, worst and median of random pairs, growth of the published]."""
    found = []
    for ratio in RATIOS:
        random = np.random.default_rng(20030501)
        gains = [gain(random_pair(ratio, random)) for _ in range(400)]
        found.append([ratio, gain(stated_pair(ratio)), gain(scene_pair(ratio)), *np.percentile(gains, [0, 50]),
                      growth(stated_pair(ratio), SPAN / STEPS)])
    return found
