"""The cases of the comparison of speed and error: scenes, what each is compared with, and the runs.

A run is demsolve with some options on a scene. What demsolve does not offer is left out (Offer).
"""

import re
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import closed_forms
import errors

RATIOS = [1, 1.44, 5, 20, 100]  # K/E
RATE = 0.1  # lam of the platens and of the stiff pillar [1/day]
LONG_STEPS = [step / RATE for step in (0.01, 0.1, 1, 10)]  # [day]
HALVED = [4, 2, 1, 0.5, 0.25, 0.125, 0.0625]  # creep steps of the wedge [day]
TIGHT = 1e-9  # tolerance of equilibria where the creep step is looked at


@dataclass(frozen=True)
class Run:
    study: str  # what is varied: "creep step", "creep tolerance", "tolerance", "zone size", or "default"
    engine: str = ""  # "" is what the program chooses
    scheme: str = ""
    step: float | None = None  # [day]
    creep_tolerance: float | None = None  # [m]
    tolerance: float | None = None
    zone_size: float | None = None  # [m]

    def options(self, offer):
        given = [("--engine", self.engine if offer.names_engines else ""),
                 ("--creep-scheme", self.scheme if offer.names_schemes else ""), ("--creep-step", self.step),
                 ("--creep-tolerance", self.creep_tolerance), ("--tolerance", self.tolerance),
                 ("--zone-size", self.zone_size)]
        return [text for name, value in given if value
                for text in (name, value if isinstance(value, str) else f"{value:.12g}")]


@dataclass
class Offer:
    """What this demsolve can do."""

    engines: list[str]
    schemes: list[str]
    names_engines: bool
    names_schemes: bool
    chooses_steps: bool

    @property
    def fastest(self):
        return self.engines[-1]

    def has(self, run):
        return (run.engine in ("", *self.engines) and run.scheme in ("", *self.schemes)
                and (run.creep_tolerance is None or self.chooses_steps))


def offer_of(demsolve):
    text = " ".join(subprocess.run([demsolve, "--help"], check=True, capture_output=True, text=True).stdout.split())

    def choices(option, all_of_them):
        """Those of all choices that stand behind the option; the first one if there is no such option."""
        after = re.search(rf"{option}\b(.*?)(?= --|$)", text)
        return [c for c in all_of_them if re.search(rf"\b{c}\b", after[1])] if after else all_of_them[:1]

    return Offer(choices("--engine", ["relaxation", "implicit"]),
                 choices("--creep-scheme", ["published", "backward", "linear-force", "fitted"]),
                 "--engine" in text, "--creep-scheme" in text, "--creep-tolerance" in text)


@dataclass
class Case:
    name: str
    title: str
    scene: str  # text
    runs: list[Run]
    error: Callable[[errors.Result], errors.Error] | None = None  # from a closed form
    references: list[Run] = field(default_factory=list)  # or from the first of these that demsolve offers
    every_state: bool = True
    is_long: bool = False  # over lam T = 10, for its own table


def edited(text, changes):
    """The scene with values of keys changed: {(name of a joint material or "", key): value}."""
    for (name, key), value in changes.items():
        start = text.index(f'name = "{name}"') if name else 0
        head, rest = text[:start], text[start:]
        rest, found = re.subn(rf"^{key} = [^#\n]*", f"{key} = {value:.12g} ", rest, count=1, flags=re.MULTILINE)
        if found != 1:
            raise ValueError(f"the scene has no {key} behind '{name}'")
        text = head + rest
    return text


def with_kelvin(text, material, stiffness, ratio, rate):
    """Kelvin constants [MPa/m, MPa day/m] that give K/E and lam [1/day], in both directions."""
    return edited(text, {(material, f"{direction}_kelvin_{what}"): value for direction in ("normal", "shear")
                         for what, value in (("stiffness_MPa_per_m", stiffness / ratio),
                                             ("viscosity_MPa_day_per_m", stiffness / ratio / rate))})


def with_default_equilibrium(text):
    return re.sub(r"(?ms)^\[equilibrium\].*?(?=^\[|\Z)", "", text)


def platens_scene(text, ratio, end=1 / RATE):
    return with_kelvin(edited(text, {("", "end"): end}), "joint", 1000, ratio, RATE)


def pillars_scene(text, ratio, end=1 / RATE):
    text = edited(text, {("", "end"): end})
    return with_kelvin(with_kelvin(text, "stiff", 100, ratio, RATE), "soft", 80, ratio / 5, RATE / 2)


def stated_pillars_scene(text, ratio):
    """Joints (2 K, 4 E) and (K, E) with the same lam, so soft that the cap is 5e6 times stiffer, under little load."""
    text = edited(text.replace("traction_MPa = [0, -0.1]", "traction_MPa = [0, -1e-4]"), {
        ("", "end"): 1 / RATE, **{(name, f"{direction}_stiffness_MPa_per_m"): stiffness
                                  for name, stiffness in (("stiff", 2), ("soft", 1))
                                  for direction in ("normal", "shear")}})
    return with_kelvin(with_kelvin(text, "stiff", 2, ratio / 2, RATE), "soft", 1, ratio, RATE)


def creep_runs(offer, engines, steps, creep_tolerances=(), **fixed):
    """Every engine and scheme at every step; and steps that the program chooses."""
    runs = [Run("creep step", engine, scheme, step=step, **fixed)
            for engine in engines for scheme in offer.schemes for step in steps]
    return runs + [Run("creep tolerance", engine, offer.schemes[-1], creep_tolerance=tolerance, **fixed)
                   for engine in engines for tolerance in creep_tolerances]


def equilibrium_runs(offer, tolerances, zone_sizes):
    runs = [Run("default")]
    runs += [Run("tolerance", engine, tolerance=t) for engine in offer.engines for t in tolerances]
    return runs + [Run("zone size", engine, zone_size=z) for engine in offer.engines for z in zone_sizes]


def closed(form):
    def error(result):
        return errors.against_closed_form(result, form(result.scene))

    return error


def groove_error(result):
    displacement, traction = closed_forms.v_groove(result.scene, result.contacts, result.traction[0], result.time,
                                                   step=0.05)
    return errors.against_tractions(result, displacement[-1:], traction)


def powers(first, last):
    return [10.0 ** -n for n in range(first, last + 1)]


def all_cases(data, offer):
    """`data` is the folder of the scenes, a Path."""
    def text(name):
        return (data / name / "scene.toml").read_text()

    column = with_default_equilibrium(text("column"))
    cases = [Case("column", "column", column, [
        *creep_runs(offer, offer.engines, [5, 2, 1, 0.5], powers(5, 7)),
        *equilibrium_runs(offer, powers(3, 9), [10, 5, 2.5, 1.25])], closed(closed_forms.column))]

    steps = [1 / RATE / 2**n for n in range(8)]
    for ratio in RATIOS:
        scene = platens_scene(text("verification/platens"), ratio)
        runs = creep_runs(offer, offer.engines, steps, powers(4, 9), tolerance=TIGHT)
        if ratio == 1.44:
            runs += equilibrium_runs(offer, powers(3, 9), [1, 0.5, 0.25])
        cases.append(Case(f"platens {ratio:g}", f"platens, K/E = {ratio:g}", scene, runs, closed(closed_forms.platens)))
    for ratio in RATIOS:
        scene = pillars_scene(text("verification/two-pillars"), ratio)
        runs = creep_runs(offer, offer.engines if ratio == 1.44 else [offer.fastest], steps, powers(4, 9),
                          tolerance=TIGHT)
        if ratio == 1.44:
            runs += equilibrium_runs(offer, powers(4, 9), [1, 0.5, 0.25])
        cases.append(Case(f"two pillars {ratio:g}", f"two pillars, K/E = {ratio:g}", scene, runs,
                          closed(closed_forms.two_pillars)))

    for kind, scene_of, name, form in (("platens", platens_scene, "platens", closed_forms.platens),
                                       ("two pillars", pillars_scene, "two-pillars", closed_forms.two_pillars)):
        for ratio in RATIOS if kind == "platens" or offer.fastest != "relaxation" else []:
            scene = scene_of(text(f"verification/{name}"), ratio, end=10 / RATE)
            runs = creep_runs(offer, [offer.fastest], LONG_STEPS, tolerance=TIGHT)
            cases.append(Case(f"{kind} {ratio:g}, long", f"{kind}, K/E = {ratio:g}, over lam T = 10", scene, runs,
                              closed(form), is_long=True))

    cases.append(Case("layered mass", "layered mass", text("verification/layered-mass"), [
        *creep_runs(offer, offer.engines, [10, 2, 0.5], powers(4, 6)),
        *equilibrium_runs(offer, powers(3, 9), [4, 2, 1])], closed(closed_forms.layered_mass)))
    cases.append(Case("incline", "incline", text("verification/incline"), [
        *creep_runs(offer, offer.engines, [5, 1], powers(4, 6)),
        *equilibrium_runs(offer, powers(4, 9), [2, 1, 0.5])], closed(closed_forms.incline)))
    cases.append(Case("V-groove", "wedge in a groove", text("verification/v-groove"), [
        *creep_runs(offer, offer.engines, HALVED, powers(5, 8), tolerance=TIGHT),
        *equilibrium_runs(offer, powers(5, 8), [])], groove_error))
    cases.append(Case("opening joints", "slope with opening joints", text("verification/opening-joints"), [
        *creep_runs(offer, offer.engines, [24, 12, 6, 3, 1.5], powers(4, 7), tolerance=1e-8),
        *equilibrium_runs(offer, powers(3, 8), [5, 2.5, 1.25]),
        *([Run("zone size", offer.fastest, zone_size=0.7)] if offer.fastest != "relaxation" else [])],
        references=[Run("reference", "implicit", "fitted", step=0.1875, tolerance=1e-10),
                    Run("reference", "relaxation", "fitted", step=0.75, tolerance=1e-10),
                    Run("reference", "relaxation", "published", step=0.1875, tolerance=1e-10)]))
    slope = [run for run in creep_runs(offer, offer.engines, [28, 14, 7, 3.5], powers(4, 7), tolerance=1e-7)
             if run.engine == offer.fastest or run.step in (28, 14) and run.scheme in ("published", "fitted")]
    cases.append(Case("slope with slip", "slope with slip", text("slope"), [
        *slope, *equilibrium_runs(offer, [1e-4, 1e-5, 1e-6, 1e-7], [6, 3]),
        *([Run("zone size", offer.fastest, zone_size=1.5)] if offer.fastest != "relaxation" else [])],
        references=[Run("reference", "implicit", "fitted", step=0.875, tolerance=1e-9),
                    Run("reference", "relaxation", "fitted", step=3.5, tolerance=1e-8),
                    Run("reference", "relaxation", "published", step=1.75, tolerance=1e-8)], every_state=False))
    return cases


def quick_cases(data, offer):
    """One case of each kind, a few short runs: what a test can wait for."""
    wanted = {"platens 20", "two pillars 1.44", "layered mass", "opening joints"}
    cases = [case for case in all_cases(data, offer) if case.name in wanted]
    for case in cases:
        case.runs = [run for run in case.runs if run.study == "default" or run.step in (24, 12, 2.5, 0.625)]
        case.references = [replace(run, step=3.0, tolerance=1e-8) for run in case.references]
    return cases
