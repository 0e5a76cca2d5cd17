"""Three creeping pillars under a rigid level cap, loaded by ramps; one is taken away while the load grows.

The pillars' joints close alike by w:  t_i = k_i (w - d_i),  eta_i d_i' = t_i - E_i d_i,  sum t_i = load. This linear system is integrated
by the classical Runge-Kutta method with steps that leave no error. Nothing fixes the force on a joint, and loads are linear in time: a
scheme for constant force or constant closure alone is of first order here.
"""

import numpy as np

from chain import ChainTest, datasets, main
from small_scene import table

STIFFNESS, KELVIN, RATE = np.array([100.0, 80, 150]), np.array([60.0, 300, 100]), np.array([0.4, 0.1, 0.25])  # MPa/m, MPa/m, 1/day
LOAD = [(0, 0), (4, 0.3), (10, 0.3), (16, 0.54)]  # day, MPa m
TAKEN, END = 12, 25  # days


def scene(creep):
    """A cap of 3 m on three joints of 1 m each, on rock that is held; the rock under the third is excavated."""
    x = [0, 1, 2, 3]
    free = {"xx": 0, "yy": 0}
    materials = [{"name": f"pillar {i}", "normal_stiffness_MPa_per_m": STIFFNESS[i], "shear_stiffness_MPa_per_m": STIFFNESS[i],
                  "cohesion_MPa": 1, "friction_angle_deg": 30, "tensile_strength_MPa": 1,
                  "normal_kelvin_stiffness_MPa_per_m": KELVIN[i], "normal_kelvin_viscosity_MPa_day_per_m": KELVIN[i] / RATE[i],
                  "shear_kelvin_stiffness_MPa_per_m": KELVIN[i], "shear_kelvin_viscosity_MPa_day_per_m": KELVIN[i] / RATE[i]}
                 for i in range(3)]
    stress = {f"compression_{c}_{what}": v for c, v in free.items() for what in ("MPa", "gradient_MPa_per_m")}
    return "\n".join([
        table("[section]", {"outline_m": [[0, -0.5], [3, -0.5], [3, 0], [3, 1], [0, 1], [0, 0]], "rock": "cap", "gravity_m_per_s2": 0}),
        table("[[rock]]", {"name": "cap", "density_kg_per_m3": 2700, "youngs_modulus_GPa": 10000, "poissons_ratio": 0}),
        *(table("[[joint_material]]", one) for one in materials),
        *(table("[[joint]]", {"name": f"J{i}", "material": f"pillar {i}", "from_m": [x[i], 0], "to_m": [x[i + 1], 0]}) for i in range(3)),
        table("[in_situ_stress]", {"elevation_m": 0, **stress, "shear_xy_MPa": 0, "shear_xy_gradient_MPa_per_m": 0}),
        table("[[boundary]]", {"from_m": [0, -0.5], "to_m": [3, -0.5], "fix": "xy"}),
        *(table("[[boundary]]", {"from_m": [side, 0], "to_m": [side, 1], "fix": "x"}) for side in (0, 3)),
        table("[[boundary]]", {"from_m": [0, 1], "to_m": [3, 1], "traction_MPa": [0, -1 / 3],
                               "load_history": [[day, load] for day, load in LOAD]}),
        table("[schedule]", {"end": END}),
        table("[[stage]]", {"name": "one is taken away", "date": TAKEN, "remove_m": [[[2, -0.5], [3, -0.5], [3, 0], [2, 0]]]}),
        table("[[point]]", {"name": "cap", "at_m": [1.5, 1]}),
        table("[creep]", creep),
        table("[zones]", {"size_m": 1}),
        table("[cutting]", {"shortest_edge_m": 1e-4})])  # joints meet within that


def exact(days):
    """How far the cap has sunk at each of the days [m], in order; TAKEN comes twice, before and after."""
    def closure(day, d, present):
        load = np.interp(day, *zip(*LOAD))
        return (load + (STIFFNESS * d)[present].sum()) / STIFFNESS[present].sum()

    def slope(day, d, present):
        traction = np.where(present, STIFFNESS * (closure(day, d, present) - d), 0)
        return RATE * (traction / KELVIN - d)

    day, d, present, found = 0.0, np.zeros(3), np.array([True] * 3), []
    for end in days:
        if found and end == day:  # just after the pillar is gone
            present = np.array([True, True, False])
        for begin, stop in zip(*(lambda cuts: (cuts[:-1], cuts[1:]))(sorted({day, end} | {at for at, _ in LOAD if day < at < end}))):
            count = max(1, int(np.ceil((stop - begin) / 0.01)))
            h = (stop - begin) / count
            for n in range(count):
                t = begin + n * h
                a = slope(t, d, present)
                b = slope(t + h / 2, d + h / 2 * a, present)
                c = slope(t + h / 2, d + h / 2 * b, present)
                d = d + h / 6 * (a + 2 * b + 2 * c + slope(t + h, d + h * c, present))
        day = end
        found.append(closure(day, d, present))
    return np.array(found)


class Pillars(ChainTest):
    def error(self, **creep):
        """Largest error of the cap's displacement over its largest, and the number of rows of the history."""
        data = datasets(self.chain.result(scene(creep)))
        days = data["/history/time"]
        sunk, answer = -data["/history/displacement"][:, 0, 1], exact(days)
        return np.abs(sunk - answer).max() / answer.max(), len(days)

    def test_default_scheme(self):
        errors = [self.error(step_days=step)[0] for step in (1, 0.5, 0.25)]
        print("steps of 1, .5, .25 days:", *(f"{error:.1e}" for error in errors))
        self.assertLess(errors[1], 1e-4)
        for coarse, fine in zip(errors, errors[1:]):  # second order, at least
            self.assertGreater(coarse / fine, 3.5)

    def test_steps_by_tolerance(self):
        error, rows = self.error(tolerance_m=5e-7)
        print(f"tolerance_m = 5e-7: {error:.1e}, {rows} rows")
        self.assertLess(error, 1e-4)
        self.assertLess(rows, 60)

    def test_a_scheme_of_first_order_is_worse(self):
        self.assertGreater(self.error(step_days=0.25, scheme="backward")[0], 1e-3)


if __name__ == "__main__":
    main()
