"""What the programs say to common mistakes, and the page that lists them: docs/troubleshooting.md.

Each mistake changes one thing in the example of docs/scene.md. The tables of the page are those that this test makes: after a
message has changed, run it with JOINTCREEP_WRITE_PAGES=1, which writes them.
"""

import os
import re

from chain import ChainTest, main

ABSENT = ""
REMOVED = r"remove_m = .*"
MISTAKES = {  # table: what is wrong, what the example has (a pattern), and what is written in its place
    "Units of rock and joints": [
        ("friction angle in radians", "friction_angle_deg = 32", "friction_angle_deg = 0.56"),
        ("friction angle as a tangent", "friction_angle_deg = 45", "friction_angle_deg = 1"),
        ("stiffness in Pa/m", "normal_stiffness_MPa_per_m = 5000", "normal_stiffness_MPa_per_m = 5e9"),
        ("stiffness in GPa/m", "normal_stiffness_MPa_per_m = 5000\nshear_stiffness_MPa_per_m = 2000",
         "normal_stiffness_MPa_per_m = 5\nshear_stiffness_MPa_per_m = 2"),
        ("stiffness in kPa/m", "normal_stiffness_MPa_per_m = 5000", "normal_stiffness_MPa_per_m = 5e6"),
        ("friction angle too large", "friction_angle_deg = 32", "friction_angle_deg = 80"),
        ("modulus in MPa", "youngs_modulus_GPa = 30", "youngs_modulus_GPa = 30000"),
        ("cohesion in kPa", "cohesion_MPa = 0.1", "cohesion_MPa = 100"),
        ("tensile strength in kPa", "tensile_strength_MPa = 1", "tensile_strength_MPa = 1000"),
        ("viscosity in MPa s/m", "normal_kelvin_viscosity_MPa_day_per_m = 1e6", "normal_kelvin_viscosity_MPa_day_per_m = 8.64e10"),
        ("viscosity in TPa day/m", "normal_kelvin_viscosity_MPa_day_per_m = 1e6", "normal_kelvin_viscosity_MPa_day_per_m = 1"),
        ("density in t/m3", "density_kg_per_m3 = 2700", "density_kg_per_m3 = 2.7"),
        ("ratio in percent", "poissons_ratio = 0.25", "poissons_ratio = 25"),
        ("persistence in percent", "persistence = 0.7", "persistence = 70"),
        ("persistence divided by 100 twice", "persistence = 0.7", "persistence = 0.007"),
        ("negative tensile strength", "tensile_strength_MPa = 0", "tensile_strength_MPa = -1"),
        ("stiffnesses exchanged", "shear_stiffness_MPa_per_m = 2000", "shear_stiffness_MPa_per_m = 20000"),
        ("tolerance of creep in mm", "tolerance_m = 1e-5", "tolerance_m = 0.02"),
    ],
    "Stress and gravity": [
        ("gravity with a sign", "gravity_m_per_s2 = 9.81", "gravity_m_per_s2 = -9.81"),
        ("no gravity", "gravity_m_per_s2 = 9.81", "gravity_m_per_s2 = 0"),
        ("compression at the datum as negative", "compression_xx_MPa = 0", "compression_xx_MPa = -3"),
        ("gradient in kPa/m", "compression_yy_gradient_MPa_per_m = .*", "compression_yy_gradient_MPa_per_m = 26.487"),
        ("compression as negative", "compression_yy_gradient_MPa_per_m = .*", "compression_yy_gradient_MPa_per_m = -0.026487"),
        ("elevation of the base, not of the ground", "elevation_m = 60", "elevation_m = 0"),
        ("ground far above the section", "elevation_m = 60", "elevation_m = 600"),
        ("stress ratio in percent", "compression_xx_MPa = 0\n(?s:.*?)shear_xy_gradient_MPa_per_m = 0",
         "horizontal_stress_ratio = 50"),
        ("stress ratio too small", "compression_xx_MPa = 0\n(?s:.*?)shear_xy_gradient_MPa_per_m = 0",
         "horizontal_stress_ratio = 0.05"),
    ],
    "Geometry": [
        ("dip in radians", 'dip = .*', 'dip = { law = "normal", mean_deg = 0.96, deviation_deg = 0.07 }'),
        ("bearing in radians", "azimuth_deg = 90", "azimuth_deg = 1.5708"),
        ("outline that crosses itself", "outline_m = .*", "outline_m = [[0, 0], [100, 60], [100, 0], [0, 60]]"),
        ("first corner repeated", "outline_m = .*", "outline_m = [[0, 0], [100, 0], [100, 60], [0, 60], [0, 0]]"),
        ("outline in millimetres", "outline_m = .*", "outline_m = [[0, 0], [100000, 0], [100000, 60000], [0, 60000]]"),
        ("map coordinates", "outline_m = .*", "outline_m = [[4500000, 0], [4500100, 0], [4500100, 60], [4500000, 60]]"),
        ("boundary not on the outline", r"to_m = \[100, 0\]", "to_m = [100, 1]"),
        ("point outside the section", r"at_m = \[39, 59\]", "at_m = [39, 61]"),
        ("point in rock that is excavated", r"at_m = \[39, 59\]", "at_m = [70, 40]"),
        ("stage without rock", REMOVED, "remove_m = [[[60, 120], [100, 120], [100, 160], [40, 160]]]"),
        ("stage that removes all rock", REMOVED, "remove_m = [[[-1, -1], [101, -1], [101, 61], [-1, 61]]]"),
        ("a bracket missing", REMOVED, "remove_m = [[60, 20], [100, 20], [100, 60], [40, 60]]"),
        ("zones too small", "size_m = 3$", "size_m = 0.003"),
        ("zones as large as the section", "size_m = 3$", "size_m = 100"),
        ("zones too large", "size_m = 3$", "size_m = 3000"),
    ],
    "Names, dates and TOML": [
        ("material misspelt", 'material = "joint"', 'material = "joints"'),
        ("key without its unit", "density_kg_per_m3 = 2700", "density = 2700"),
        ("text without quotes", 'rock = "granite"', "rock = granite"),
        ("decimal comma", "size_m = 3$", "size_m = 3,5"),
        ("one bracket in place of two", r"\[\[point\]\]", "[point]"),
        ("two points with one name", r"\[\[point\]\]", '[[point]]\nname = "crest"\nat_m = [30, 50]\n[[point]]'),
        ("stage before the start", "date = 1994-06-15", "date = 1993-06-15"),
        ("date as a text", "date = 1994-06-15", 'date = "1994-06-15"'),
        ("date with points", "date = 1994-06-15", "date = 15.06.1994"),
        ("no end", "end = 1995-06-01", ABSENT),
        ("dip without the bearing of the section", "azimuth_deg = 90", ABSENT),
        ("joint set without a seed", r"\[random\]\nseed = 1", ABSENT),
        ("end of a text forgotten", 'title = "A slope"', 'title = "A slope'),
        ("no boundary", r"\[\[boundary\]\](?s:.*)(?=\[schedule\])", ABSENT),
    ],
}
HEAD = "| mistake | written | exit code | message |\n|---|---|---|---|\n"


def shown(message):
    """The first message, without the program's name and lists of keys, in a cell of a table."""
    first = re.sub(r" \(its keys: .*\)", "", message.splitlines()[0].removeprefix("jointgen: "))
    return "`" + first.replace("|", "or") + "`"


class Mistakes(ChainTest):
    def setUp(self):
        (self.example,) = re.findall(r"(?ms)^```toml\n(title.*?)^```$", self.chain.text("docs/scene.md"))

    def checked(self, text):
        (self.chain.folder / "scene.toml").write_text(text)
        return self.chain.answer("jointgen", "scene.toml", "--check", "--quiet")

    def row(self, what, pattern, written):
        text, found = re.subn(rf"(?m)^(?:{pattern})", lambda _: written, self.example, count=1)
        self.assertEqual(found, 1, what)
        done = self.checked(text)
        self.assertIn(done.returncode, (0, 2), what)
        self.assertNotEqual(done.stderr, "", f"{what}: nothing is said")
        line = written.splitlines()[0] if written else ""
        return f"| {what} | {f'`{line}`' if line else ''} | {done.returncode} | {shown(done.stderr)} |\n"

    def test_the_example_has_none(self):
        done = self.checked(self.example)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_the_page(self):
        page = self.chain.text("docs/troubleshooting.md")
        tables = {title: HEAD + "".join(self.row(*mistake) for mistake in mistakes) for title, mistakes in MISTAKES.items()}
        self.assertGreaterEqual(sum(map(len, MISTAKES.values())), 30)
        wanted = page
        for title, table in tables.items():
            wanted, found = re.subn(rf"(?ms)^## {title}\n\n\|.*?\|\n(?=\n)", lambda _, t=title, rows=table: f"## {t}\n\n{rows}", wanted)
            self.assertEqual(found, 1, title)
        if os.environ.get("JOINTCREEP_WRITE_PAGES"):
            (self.chain.source / "docs/troubleshooting.md").write_text(wanted)
        self.assertEqual(page, wanted)


if __name__ == "__main__":
    main()
