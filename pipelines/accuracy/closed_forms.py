"""Exact answers to the scenes of data/verification, and a rigid body followed in tiny steps where there are none.

A closed form takes a scene, as tomllib reads it, and gives an Answer: where the monitoring points are and what the
contacts bear, at any time. Signs are those of the files: displacements to the right and up, tension and opening
positive. Stresses in Pa, lengths in m, times in days since the start. A load that a scene ramps within a tiny part
of a day counts as put on at once, at the start.

A joint is a spring K in series with a Kelvin element, a spring E beside a dashpot eta (per area of joint). Under a
constant traction F put on at once it gives way by  F (1/K + (1 - exp(-E T / eta)) / E)  (Jin, Zhang, Wang, Wang:
Creep Modeling in Excavation Analysis of a High Rock Slope, ASCE 2003, Eq. 11).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import column_closed_form


@dataclass
class Joint:
    """One direction of a joint."""

    stiffness: float  # K [Pa/m]
    kelvin_stiffness: float  # E [Pa/m]
    kelvin_viscosity: float  # eta [Pa day/m]

    @property
    def rate(self):
        """lam [1/day]"""
        return self.kelvin_stiffness / self.kelvin_viscosity

    def compliance(self, days):
        """What it gives way under a constant traction of 1, put on at once [m/Pa]."""
        return 1 / self.stiffness - math.expm1(-self.rate * days) / self.kelvin_stiffness


@dataclass
class Contacts:
    """Those of a result file, one row each."""

    position: np.ndarray  # {x, y} [m]
    normal: np.ndarray  # unit, from side a to side b
    length: np.ndarray  # [m]
    material: list[str]

    @property
    def tangent(self):
        return np.stack([self.normal[:, 1], -self.normal[:, 0]], axis=1)


@dataclass
class Answer:
    displacement: Callable[[str, float], np.ndarray]  # (point, day) -> {x, y} [m]; nan where nothing holds it
    traction: Callable[[Contacts, float, int], np.ndarray]  # (contacts, day, stages done) -> [contact, 2] [Pa]
    scale: float  # the largest traction in the answer [Pa]


def joint_of(scene, name, direction):
    material = next(m for m in scene["joint_material"] if m["name"] == name)
    return Joint(*(material[f"{direction}_{what}"] * 1e6 for what in
                   ("stiffness_MPa_per_m", "kelvin_stiffness_MPa_per_m", "kelvin_viscosity_MPa_day_per_m")))


def rock_compliance(scene):
    """Of rock under uniaxial stress in plane strain with free sides, (1 - nu^2) / E_r [1/Pa]."""
    rock = scene["rock"][0]
    return (1 - rock["poissons_ratio"] ** 2) / (rock["youngs_modulus_GPa"] * 1e9)


def corners(scene):
    return np.array(scene["section"]["outline_m"], float)


def points(scene):
    return {point["name"]: np.array(point["at_m"], float) for point in scene["point"]}


def load(scene, key):
    """The one load of that key that has a load history, {x, y}; of several like it the last."""
    return np.array([b for b in scene["boundary"] if key in b and "load_history" in b][-1][key], float)


def column(scene):
    """data/column: the rises of pipelines/plots/column_closed_form.py; a joint bears the weight of what is above it."""
    of_scene = column_closed_form.column_of(scene)
    weight = scene["rock"][0]["density_kg_per_m3"] * scene["section"]["gravity_m_per_s2"]
    tops = [float(corners(scene)[:, 1].max()), *(removal.bottom for removal in of_scene.removals)]

    def displacement(point, day):
        return np.array([math.nan, column_closed_form.rise(of_scene, of_scene.points[point], day)])

    def traction(contacts, day, stages):
        above = np.maximum(0, tops[stages] - contacts.position[:, 1])
        return np.outer(-weight * above, [1, 0])

    return Answer(displacement, traction, weight * (tops[0] - of_scene.base))


def platens(scene):
    """data/verification/platens: a joint between two blocks is squeezed by u0 at T = 0, and held.

    The blocks, of the height h together, are a spring in series with the joint's: 1/K' = 1/K + h (1 - nu^2) / E_r.
    With d' = (F - E d) / eta and F = K' (u0 - d),
        F(T) = u0 (K_inf + (K' - K_inf) exp(-T (K' + E) / eta)),     K_inf = K' E / (K' + E).
    """
    joint = joint_of(scene, "joint", "normal")
    c = rock_compliance(scene)
    height = float(np.ptp(corners(scene)[:, 1]))
    u0 = -load(scene, "displacement_mm")[1] * 1e-3
    k = 1 / (1 / joint.stiffness + height * c)
    k_inf = k * joint.kelvin_stiffness / (k + joint.kelvin_stiffness)

    def pressure(day):
        decay = math.exp(-day * (k + joint.kelvin_stiffness) / joint.kelvin_viscosity)
        return u0 * (k_inf + (k - k_inf) * decay) if day > 0 else 0.0

    where = points(scene)
    sideways = scene["rock"][0]["poissons_ratio"] / (1 - scene["rock"][0]["poissons_ratio"])  # of the free side

    def displacement(point, day):
        x, y = where[point]
        if day == 0:
            return np.zeros(2)
        strain = pressure(day) * c
        return np.array([sideways * strain * x, -u0 + strain * (height - y)])

    def traction(contacts, day, stages):
        return np.outer(np.full(len(contacts.length), -pressure(day)), [1, 0])

    return Answer(displacement, traction, k * u0)


def shares(stiffness, kelvin_stiffness, viscosity, weight, days):
    """Forces on joints that a rigid level cap closes alike, with the weight put on at T = 0, and their closure.

    With w the closure, F_i = K_i (w - d_i), sum F_i = weight, and d_i' = (F_i - E_i d_i) / eta_i: a linear system
    d' = A d + b, solved by the eigenvalues of A. All per joint: N/m of closure, N day/m, N.
    """
    k, e, eta = (np.asarray(values, float) for values in (stiffness, kelvin_stiffness, viscosity))
    a = (np.outer(k, k) / k.sum() - np.diag(k + e)) / eta[:, None]
    b = k * weight / k.sum() / eta
    final = np.linalg.solve(a, -b)
    values, vectors = np.linalg.eig(a)
    d = final + (vectors * np.exp(values * days)) @ np.linalg.solve(vectors, -final)
    closure = (weight + k @ d.real) / k.sum()
    return k * (closure - d.real), closure


def two_pillars(scene):
    """data/verification/two-pillars: see shares(); lengths as the scene's two boundaries with joints say."""
    resting = [b for b in scene["boundary"] if "joint" in b]
    length = {b["joint"]: float(np.linalg.norm(np.subtract(b["to_m"], b["from_m"]))) for b in resting}
    joints = {name: joint_of(scene, name, "normal") for name in length}
    pressure = -load(scene, "traction_MPa")[1] * 1e6
    weight = pressure * sum(length.values())

    def solved(day):
        forces, closure = shares(*([getattr(j, what) * length[name] for name, j in joints.items()] for what in
                                   ("stiffness", "kelvin_stiffness", "kelvin_viscosity")), weight, day)
        return dict(zip(length, forces)), closure

    def traction(contacts, day, stages):
        forces, _ = solved(day)
        normal = [-forces[name] / length[name] if day > 0 else 0.0 for name in contacts.material]
        return np.outer(normal, [1, 0])

    scale = max(forces / length[name] for name, forces in solved(0)[0].items())
    return Answer(lambda point, day: np.array([0, -solved(day)[1] if day > 0 else 0.0]), traction, scale)


def incline(scene):
    """data/verification/incline: a rigid block on a joint at the angle b is loaded by q, straight down, at T = 0.

    With q per area of the joint, its middle moves by q sin b J_s(T) down the dip and by q cos b J_n(T) into the
    joint, J being the compliances. Shear is the same all along. The load, at the height h above the joint, also
    turns the block: the normal traction is q cos b plus a part that is linear along the joint and balances the
    moment q L h sin b.
    """
    joint = {direction: joint_of(scene, "joint", direction) for direction in ("normal", "shear")}
    low, high = (corners(scene)[i] for i in (0, 1))
    top = corners(scene)[2:].mean(axis=0)
    length = float(np.linalg.norm(high - low))
    along = (high - low) / length
    normal = np.array([-along[1], along[0]])
    middle = (low + high) / 2
    height = float((top - middle) @ normal)
    q = -load(scene, "traction_MPa")[1] * 1e6
    sin_b, cos_b = along[1], along[0]

    def displacement(point, day):
        if day == 0:
            return np.zeros(2)
        return -q * (sin_b * joint["shear"].compliance(day) * along + cos_b * joint["normal"].compliance(day) * normal)

    def traction(contacts, day, stages):
        place = (contacts.position - middle) @ along
        turning = q * length * height * sin_b / (contacts.length @ place**2) * place
        tau = -q * sin_b * (contacts.tangent @ along)
        return np.stack([-q * cos_b + turning, tau], axis=1) if day > 0 else np.zeros((len(place), 2))

    return Answer(displacement, traction, q)


def layered_mass(scene):
    """data/verification/layered-mass: uniaxial load q on a rock mass with one through-going set of joints.

    The stress is q downwards everywhere. Rock shortens by q (1 - nu^2) / E_r and widens by q nu (1 + nu) / E_r; at each
    joint, at the angle b, what is above moves by  q cos^2 b J_n  into it and by  q sin b cos b J_s  down its dip. Over
    whole spacings S that adds up to the strain  q (1 - nu^2) / E_r + (cos^4 b J_n + sin^2 b cos^2 b J_s) q / S
    (Amadei & Goodman, for the normal part). Displacements count from the two pieces that are held.
    """
    rock = scene["rock"][0]
    nu, young = rock["poissons_ratio"], rock["youngs_modulus_GPa"] * 1e9
    joint = {direction: joint_of(scene, "joint", direction) for direction in ("normal", "shear")}
    q = -load(scene, "traction_MPa")[1] * 1e6
    lines = [(np.array(j["from_m"], float), np.array(j["to_m"], float)) for j in scene["joint"]]
    where = points(scene)
    held_y = next(b["from_m"][1] for b in scene["boundary"] if b.get("fix") == "y")
    held_x = next(b["from_m"][0] for b in scene["boundary"] if b.get("fix") == "x")

    def displacement(point, day):
        if day == 0:
            return np.zeros(2)
        x, y = where[point]
        moved = q * np.array([nu * (1 + nu) / young * (x - held_x), -(1 - nu**2) / young * (y - held_y)])
        for start, end in lines:
            along = (end - start) / np.linalg.norm(end - start)
            normal = np.array([-along[1], along[0]])
            if (where[point] - start) @ normal > 0:
                sin_b, cos_b = along[1], along[0]
                moved -= q * cos_b * (cos_b * joint["normal"].compliance(day) * normal
                                      + sin_b * joint["shear"].compliance(day) * along)
        return moved

    def traction(contacts, day, stages):
        n = contacts.normal
        return -q * n[:, 1:] * np.stack([n[:, 1], -n[:, 0]], axis=1) if day > 0 else np.zeros_like(n)

    return Answer(displacement, traction, q)


# A rigid body on contacts, in tiny steps.


@dataclass
class Law:
    """A contact's, per area; one number or one per contact."""

    k: np.ndarray  # {normal, shear} [contact, 2] [Pa/m]
    e: np.ndarray  # Kelvin stiffness, the same
    eta: np.ndarray  # Kelvin viscosity, the same [Pa day/m]
    tan_phi: np.ndarray  # [contact]


def law_of(scene, contacts):
    def value(direction, what):
        return [getattr(joint_of(scene, name, direction), what) for name in contacts.material]

    k, e, eta = (np.stack([value("normal", what), value("shear", what)], axis=1)
                 for what in ("stiffness", "kelvin_stiffness", "kelvin_viscosity"))
    angle = {m["name"]: math.radians(m["friction_angle_deg"]) for m in scene["joint_material"]}
    return Law(k, e, eta, np.tan([angle[name] for name in contacts.material]))


def rigid_body(contacts, law, first_traction, force_at, days, step):
    """Motion of a rigid body (side b) on cohesionless contacts to the ground (side a), followed in tiny steps.

    first_traction  [contact, {normal, shear}] at the start, in balance; what it bears does not creep
    force_at        day -> change of the load since the start {x, y, moment about the origin} [N, N, N m]
    days            times asked for, increasing, from 0
    Returns displacements {x, y, rotation} and tractions at these times. Each step takes the Kelvin parts to its end
    with the mean of the tractions at its two ends (second order), and finds the balance by Newton's method. A step
    in which a contact closes is halved again and again around that time.
    """
    n, t = contacts.normal, contacts.tangent
    x, y = contacts.position.T

    def lever(direction):  # displacement along it per {x, y, rotation}
        return np.stack([direction[:, 0], direction[:, 1], x * direction[:, 1] - y * direction[:, 0]], axis=1)

    to_normal, to_shear = lever(n), lever(t)

    def total(sigma, tau):
        return to_normal.T @ (contacts.length * sigma) + to_shear.T @ (contacts.length * tau)

    start = total(*first_traction.T)

    def respond(q, d, slip):
        sigma = first_traction[:, 0] + law.k[:, 0] * (to_normal @ q - d[:, 0])
        trial = first_traction[:, 1] + law.k[:, 1] * (to_shear @ q - d[:, 1] - slip)
        is_open = sigma > 0
        limit = np.where(is_open, 0, -sigma * law.tan_phi)
        slips = ~is_open & (np.abs(trial) > limit)
        tau = np.clip(trial, -limit, limit)
        return np.where(is_open, 0, sigma), tau, trial, is_open, slips

    def balance(q, d, slip, force):
        for _ in range(200):
            sigma, tau, trial, is_open, slips = respond(q, d, slip)
            out = force + start - total(sigma, tau)
            if np.abs(out).max() < 1e-11 * np.abs(start).max():
                return q, sigma, tau, trial
            k_n = np.where(is_open, 0, law.k[:, 0]) * contacts.length
            k_s = np.where(is_open | slips, 0, law.k[:, 1]) * contacts.length
            k_sn = np.where(slips, -np.sign(trial) * law.tan_phi, 0) * k_n
            jacobian = (to_normal.T * k_n + to_shear.T * k_sn) @ to_normal + (to_shear.T * k_s) @ to_shear
            q = q + np.linalg.solve(jacobian, out)
        raise ArithmeticError("the rigid body finds no balance")

    def take_step(state, begin, dt):
        """The state (displacements, Kelvin parts, slip, traction) after dt, and which contacts are open then."""
        moved, kelvin, slip, last = state
        decay = np.exp(-law.e / law.eta * dt)
        traction = last
        for _ in range(3):  # predictor, corrector twice
            mean = (last + traction) / 2 - first_traction
            d = kelvin * decay + (1 - decay) * mean / law.e
            q, sigma, tau, trial = balance(moved, d, slip, force_at(begin + dt))
            traction = np.stack([sigma, tau], axis=1)
        return (q, d, slip + (trial - tau) / law.k[:, 1], traction), sigma == 0

    def advance(state, is_open, begin, dt, cuts):
        after, opened = take_step(state, begin, dt)
        if cuts > 0 and (is_open & ~opened).any():  # where on the way it closes decides its shear from then on
            half, opened = advance(state, is_open, begin, dt / 2, cuts - 1)
            return advance(half, opened, begin + dt / 2, dt / 2, cuts - 1)
        return after, opened

    state = (np.zeros(3), np.zeros((len(x), 2)), np.zeros(len(x)), np.array(first_traction, float))
    is_open = np.zeros(len(x), bool)
    found = [(state[0], state[3])]
    now = 0.0
    for day in days[1:]:
        n_steps = max(1, math.ceil((day - now) / step * (1 - 1e-9)))
        for i in range(n_steps):
            begin = now + (day - now) * i / n_steps
            state, is_open = advance(state, is_open, begin, (day - now) / n_steps, 20)
        now = day
        found.append((state[0], state[3]))
    return np.array([q for q, _ in found]), np.array([f for _, f in found])


def v_groove(scene, contacts, first_traction, days, step=0.01):
    """data/verification/v-groove by rigid_body(): its point's displacements [day, 2], tractions [day, contact, 2]."""
    push = next(b for b in scene["boundary"] if "traction_MPa" in b)
    ends = np.array([push["from_m"], push["to_m"]], float)
    whole = np.array(push["traction_MPa"]) * 1e6 * np.linalg.norm(ends[1] - ends[0])
    place = ends.mean(axis=0)
    times, factors = np.array(push["load_history"], float).T

    def force_at(day):
        force = whole * np.interp(day, times, factors)
        return np.array([*force, place[0] * force[1] - place[1] * force[0]])

    q, tractions = rigid_body(contacts, law_of(scene, contacts), first_traction, force_at, days, step)
    (x, y), = points(scene).values()
    return np.stack([q[:, 0] - q[:, 2] * y, q[:, 1] + q[:, 2] * x], axis=1), tractions


def single_contact(scene, contacts, first_traction, days, step=1e-3):
    """data/verification/single-contact: tractions [day, contact, 2] of contacts whose relative displacement is the top's displacement.

    In tiny steps: the Kelvin parts go to the end of each with the mean of the tractions at its two ends.
    """
    law = law_of(scene, contacts)
    top = next(b for b in scene["boundary"] if "displacement_mm" in b)
    times, factors = np.array(top["load_history"], float).T
    to_relative = np.stack([contacts.normal, contacts.tangent], axis=1) @ (1e-3 * np.array(top["displacement_mm"], float))
    last = np.array(first_traction, float)
    kelvin, slip, now, found = np.zeros_like(last), np.zeros(len(last)), 0.0, [last]
    for day in days[1:]:
        n_steps = max(1, math.ceil((day - now) / step * (1 - 1e-9)))
        dt = (day - now) / n_steps
        decay = np.exp(-law.e / law.eta * dt)
        for i in range(n_steps):
            sprung = to_relative * np.interp(now + (i + 1) * dt, times, factors)
            traction = last
            for _ in range(3):
                after = kelvin * decay + (1 - decay) * ((last + traction) / 2 - first_traction) / law.e
                sigma, trial = (first_traction + law.k * (sprung - after)).T - np.stack([0 * slip, law.k[:, 1] * slip])
                limit = np.maximum(-sigma * law.tan_phi, 0)
                tau = np.clip(trial, -limit, limit)
                traction = np.stack([np.minimum(sigma, 0), tau], axis=1)
            kelvin, last, slip = after, traction, slip + (trial - tau) / law.k[:, 1]
        now = day
        found.append(last)
    return np.array(found)


# Problems of the literature. Compression and pressures are positive here, angles in radians, all else in SI.


def kirsch_displacement(place, pressure, young, nu, radius=1.0):
    """Displacements {x, y} at places [n, 2] by which the rock about a circular hole at the origin moves when it is dug.

    In plane strain, under the pressures {along x, along y} from afar (Kirsch 1898; Jaeger and Cook, Fundamentals of
    Rock Mechanics).
    """
    r, angle = np.hypot(*place.T), np.arctan2(*place.T[::-1])
    both, apart = pressure[0] + pressure[1], pressure[0] - pressure[1]
    reach, near = (1 + nu) / (2 * young) * radius**2 / r, (radius / r) ** 2
    inward = reach * (both + apart * (4 * (1 - nu) - near) * np.cos(2 * angle))
    around = reach * apart * (2 * (1 - 2 * nu) + near) * np.sin(2 * angle)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([-inward * c - around * s, -inward * s + around * c], axis=1)


def kirsch_hoop(place, pressure, radius=1.0):
    """Compression around the hole at places [n, 2], as in kirsch_displacement()."""
    near, angle = (radius / np.hypot(*place.T)) ** 2, np.arctan2(*place.T[::-1])
    both, apart = pressure[0] + pressure[1], pressure[0] - pressure[1]
    return both / 2 * (1 + near) - apart / 2 * (1 + 3 * near**2) * np.cos(2 * angle)


def cantilever_deflection(length, depth, force, young, nu):
    """Of the tip, in plane strain, by bending and shear: F L^3 / (3 E' I) + 1.2 F L / (G A) (Timoshenko)."""
    bending = force * length**3 / (3 * young / (1 - nu**2) * depth**3 / 12)
    return bending + 1.2 * force * length / (young / (2 * (1 + nu)) * depth)


def two_slabs_deflection(length, depth, force, young, nu, k_s):
    """Of the tip of two equal cantilevers, one on the other, with a joint between them that shears but does not open (Newmark,
    Siess and Viest 1951): the joint's shear traction k_s x slip makes them one beam in part. In plane strain, with shear as in
    cantilever_deflection; force is that on both."""
    stiff = young / (1 - nu**2)
    own = 2 * stiff * depth**3 / 12  # of the two by themselves [N m2 / m]
    alpha = math.sqrt(k_s * (2 / (stiff * depth) + depth**2 / own))
    beta, x = k_s * depth / own, alpha * length
    # The axial force N of a slab: N'' = alpha^2 N - beta M, no slip at the clamp, no force at the tip.
    b = beta * force / alpha**3
    a = -b * math.tanh(x)
    moment = beta / alpha**2 * force * length**3 / 3
    moment += a * (math.cosh(x) - 1) / alpha**2 + b * (math.sinh(x) / alpha**2 - length / alpha)  # of N about the tip
    shear = 1.2 * force * length / (young / (2 * (1 + nu)) * 2 * depth)
    return (force * length**3 / 3 - depth * moment) / own + shear


def plane_of_weakness(dip, confining, joint, rock):
    """The axial stress at failure, and what fails; joint and rock are {cohesion, friction angle} (Jaeger 1960)."""
    (c, phi), (rock_c, rock_phi) = joint, rock
    n = (1 + math.sin(rock_phi)) / (1 - math.sin(rock_phi))
    strength = n * confining + 2 * rock_c * math.sqrt(n)
    if dip <= phi:
        return strength, "rock"
    slips = confining + (c + confining * math.tan(phi)) / (
        math.cos(dip) * (math.sin(dip) - math.cos(dip) * math.tan(phi)))
    return min((strength, "rock"), (slips, "joint"))


def roof_wedge(down, horizontal, height, half_angle, normal_stiffness, shear_stiffness, phi):
    """The force that moves a rigid symmetric wedge down by so much, against a horizontal stress.

    Each of its two faces, of the length h / cos(a), bears H = stress x h at the start. With N = H cos(a) - K_n u sin(a)
    and S = H sin(a) + K_s u cos(a), at most N tan(phi), the force is 2 (S cos(a) - N sin(a)). It is largest where slip
    begins: 2 H (K_s cos^2 a + K_n sin^2 a) sin(phi - a) / (K_s cos a cos phi + K_n sin a sin phi)
    (Crawford and Bray 1983).
    """
    s, c = math.sin(half_angle), math.cos(half_angle)
    face, thrust = height / c, horizontal * height
    normal = max(0.0, thrust * c - normal_stiffness * face * down * s)
    shear = min(thrust * s + shear_stiffness * face * down * c, normal * math.tan(phi))
    return 2 * (shear * c - normal * s)


def roof_wedge_limit(horizontal, height, half_angle, normal_stiffness, shear_stiffness, phi):
    """The largest force of roof_wedge(), and the way down at which it is reached."""
    s, c = math.sin(half_angle), math.cos(half_angle)
    down = horizontal * c * math.sin(phi - half_angle) / (
        shear_stiffness * c * math.cos(phi) + normal_stiffness * s * math.sin(phi))
    given = (horizontal, height, half_angle, normal_stiffness, shear_stiffness, phi)
    return roof_wedge(down, *given), down


def slipping_crack(dip, length, slipping, normal_stiffness, shear_stiffness, phi):
    """Axial compliances [m per N/m] of two rigid halves on a crack of which a part slips: {slips, holds, slips back}.

    Under the force P the crack closes by P cos(b) / (K_n L). Of the shear P sin(b) the slipping part, a share x of the
    length, takes +-x P cos(b) tan(phi) as it slips, and the rest goes to K_s (1 - x) L; without slip all goes to K_s L.
    (Olsson's crack, 1982, with the springs of Brady, Cramer and Hart, 1985. Their slopes take the friction of the whole
    crack in place of that of its slipping part, and add both compliances in shear, so they are others.)
    """
    s, c, x = math.sin(dip), math.cos(dip), slipping / length
    closes = c**2 / (normal_stiffness * length)

    def slips(sign):
        return closes + s * (s - sign * x * c * math.tan(phi)) / (shear_stiffness * (1 - x) * length)

    return slips(1), closes + s**2 / (shear_stiffness * length), slips(-1)


def brady_slopes(dip, length, slipping, normal_stiffness, shear_stiffness, phi, specimen):
    """Axial compliances by Brady, Cramer and Hart (1985), those of slipping_crack(); the specimen is {H, W, E}."""
    s, c = math.sin(dip), math.cos(dip)
    height, width, young = specimen
    holds = height / (width * young) + (c**2 / normal_stiffness + s**2 / shear_stiffness) / length

    def slips(sign):
        return holds + s * math.sin(dip - sign * phi) / (shear_stiffness * (length - slipping) * math.cos(phi))

    return slips(1), holds, slips(-1)


def cyclic_force(displacements, compliances):
    """Forces on a slipping_crack() that is taken from 0 through these displacements, one after the other."""
    up, hold, down = (1 / compliance for compliance in compliances)
    force, at, found = 0.0, 0.0, []
    for u in displacements:
        force += hold * (u - at)  # then slip, one way or the other, keeps it between the two lines through 0
        force, at = min(max(force, down * u), up * u), u
        found.append(force)
    return found


def toppling_columns(heights, width, head_step, crest, unit_weight, dip, tan_phi):
    """Forces between columns on a stepped base, [i] onto column i from the one above it, and the force on a smooth toe.

    Columns count from the toe; up to `crest` they rise by `head_step` from head to head, those behind fall by it. The
    last ones stand; from there on each column topples about its lower edge, pushed at the top of its side and holding
    against the top of the next one's, with friction on both sides; or, from some column on, all slide as one body
    (Goodman and Bray 1976; Wyllie and Mah, Rock Slope Engineering). The toe is smooth: no friction holds there. Also
    the column from which on they slide, -1 if none does.
    """
    s, c = math.sin(dip), math.cos(dip)
    force, forces = 0.0, [0.0] * len(heights)
    for i in reversed(range(len(heights))):
        forces[i] = force
        y = heights[i]
        pushed, holding = (y - head_step if i >= crest else y), (y - head_step if i <= crest else y)
        weight = unit_weight * width * y
        topples = (force * (pushed - width * tan_phi) + weight / 2 * (y * s - width * c)) / holding
        slides = force - weight * (c * tan_phi - s) / (1 - tan_phi**2)
        if slides > max(topples, 0):
            below = unit_weight * width * sum(heights[:i + 1])
            return forces, force * (1 - tan_phi**2) + below * (s - c * tan_phi), i
        force = max(topples, 0.0)
    return forces, force, -1


def is_sum_of(columns, wanted):
    """Whether a vector is a sum of columns with factors that are not negative (Lawson and Hanson's least squares)."""
    factors, active = np.zeros(columns.shape[1]), np.zeros(columns.shape[1], bool)
    while True:
        gain = np.where(active, -1, columns.T @ (wanted - columns @ factors))
        if gain.max() <= 1e-10 * np.linalg.norm(wanted):
            return bool(np.linalg.norm(wanted - columns @ factors) < 1e-9 * np.linalg.norm(wanted))
        active[gain.argmax()] = True
        while True:
            found = np.zeros_like(factors)
            found[active] = np.linalg.lstsq(columns[:, active], wanted, rcond=None)[0]
            leaves = active & (found <= 0)
            if not leaves.any():
                break
            factors += (factors[leaves] / (factors[leaves] - found[leaves])).min() * (found - factors)
            active &= factors > 1e-14 * factors.max()
            factors[~active] = 0
        factors = found


def layers_shear_modulus(shear_modulus, shear_stiffness, spacing):
    """Of rock with one set of joints, along them: 1 / (1/G + 1/(K_s S)) (Amadei and Goodman 1981)."""
    return 1 / (1 / shear_modulus + 1 / (shear_stiffness * spacing))


def p_wave(young, nu, density):
    """Speed of a plane P-wave and impedance, density times speed."""
    speed = math.sqrt(young * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / density)
    return speed, density * speed


def step_through_a_joint(times, pressure, impedance, stiffness):
    """Displacement behind a joint after the arrival of a step of stress, at times since then [s].

    Behind the joint a step p of stress is p (1 - exp(-t / T)), T = z / (2 K_n): the transmitted share of a harmonic wave is
    1 / (1 + i w T) (Schoenberg 1980). The velocity of the rock is the stress over the impedance z.
    """
    lag = impedance / (2 * stiffness)
    t = np.maximum(times, 0)
    return pressure / impedance * (t + lag * np.expm1(-t / lag))
