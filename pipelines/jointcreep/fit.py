"""jointcreep fit: joint sets of a scene from mapped traces, and from poles."""

import json
import pathlib

import numpy as np

from . import files, length_laws, orientation_laws, traces
from .errors import NotWanted


def number_in(options, name, low, high):
    """The value of an option, or None."""
    text = options.get(name)
    if text is None:
        return None
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not low <= value <= high:
        raise NotWanted(f'--{name} is "{text}"; expected a number from {low:g} to {high:g}')
    return value


class Set:
    """A joint set: what its traces in the window say."""

    def __init__(self, name, seen, shortest, longest, chosen):
        self.name, self.seen = name, seen
        length_laws.enough(seen, f'set "{name}"')
        self.rows = []  # (fit, naive fit, check), the best by traces held back first
        for law in length_laws.laws(shortest, longest):
            found, check = length_laws.fit(law, seen), length_laws.held_back(law, seen)
            if found and check and taken_by_scene(found):
                self.rows.append((found, length_laws.fit(law, seen, length_laws.naive_log_likelihoods), check))
        self.rows.sort(key=lambda row: (row[0].law.word != chosen, -row[2].log_likelihood))
        if not self.rows or (chosen and self.rows[0][0].law.word != chosen):
            raise NotWanted(f'set "{name}": {f"the law {chosen}" if chosen else "no law"} could be fitted to its lengths; too few of its '
                            "ends are inside, or (of a power law) --shortest and --longest are missing or do not hold the lengths")
        self.length = self.rows[0][0]
        at = np.array([seen.shortest])
        chance = (seen.chord_area * self.length.law.survival(self.length.constants, at)
                  + seen.chord_width * self.length.law.beyond(self.length.constants, at))
        self.angle = orientation_laws.trace_angle(seen, chance)
        self.p20, self.p21, self.p21_interval = length_laws.density(self.length, seen)


def taken_by_scene(found):
    """Whether a scene takes the law: of a normal one the mean is 3 deviations or more."""
    return found.law.word != "normal" or found.constants[0] >= 3 * found.constants[1]


def shown(value):
    return f"{value:.5g}"


def range_text(interval):
    return f"{shown(interval[0])} to {shown(interval[1])}"


def law_text(found):
    """The law as a scene has it."""
    keys = [f"law = {json.dumps(found.law.word)}"]
    keys += [f"{name} = {shown(value)}" for name, value in zip(found.law.constants, found.constants)]
    keys += [f"{name} = {value:.12g}" for name, value in found.law.fixed]
    return "{ " + ", ".join(keys) + " }"


def intervals_text(found):
    return ", ".join(f"{name} {range_text(interval)}" for name, interval in zip(found.law.constants, found.intervals))


def set_text(one, material, poles):
    """A [[joint_set]] with its intervals."""
    lines = ["[[joint_set]]", f"name = {json.dumps(one.name, ensure_ascii=False)}",
             f"material = {json.dumps(material, ensure_ascii=False)}", 'kind = "segments"']
    if poles:
        lines += [f"# {poles.number} poles; 95 percent: mean pole within {shown(poles.cone)} degrees, concentration "
                  f"{range_text(poles.concentration_interval)}",
                  f'orientation = {{ law = "Fisher", mean_dip_deg = {shown(poles.dip)}, mean_dip_direction_deg = '
                  f"{shown(poles.dip_direction)}, concentration = {shown(poles.concentration)} }}"]
    else:
        lines += [f"# 95 percent: mean_deg {range_text(one.angle.mean_interval)}, deviation_deg "
                  f"{range_text(one.angle.deviation_interval)}",
                  f'trace_angle = {{ law = "normal", mean_deg = {shown(one.angle.mean)}, deviation_deg = '
                  f"{shown(max(one.angle.deviation, 1e-3))} }}"]
    check = one.rows[0][2]
    lines += [f"# {len(one.seen)} traces, {(one.seen.cut_ends == 0).sum()} of them whole; 95 percent: {intervals_text(one.length)}; "
              f"held back: D {shown(check.distance)}, p {shown(check.p)}",
              f"length = {law_text(one.length)}", f"# 95 percent: {range_text(one.p21_interval)}",
              f"density = {{ P21_per_m = {shown(one.p21)} }}"]
    return "\n".join(lines) + "\n"


def summary(one):
    """What was fitted to a set, for a person."""
    seen = one.seen
    lines = [f'set "{one.name}": {len(seen)} traces in the window, {(seen.cut_ends == 0).sum()} whole, '
             f"{(seen.cut_ends == 1).sum()} cut at one end, {(seen.cut_ends == 2).sum()} at both; "
             f"P20 {shown(one.p20)} 1/m2, P21 {shown(one.p21)} 1/m",
             "  law                   log-likelihood  held back, a trace        D         p  constants; 95 percent"]
    for found, _, check in one.rows:
        constants = ", ".join(f"{name} {shown(value)}" for name, value in zip(found.law.constants, found.constants))
        lines.append(f"  {found.law.word:22}{found.log_likelihood:14.4f}{check.log_likelihood:20.4f}{check.distance:9.4f}"
                     f"{check.p:10.4g}  {constants}; {intervals_text(found)}")
    naive = one.rows[0][1]
    if naive:
        lines.append("  as if nothing were cut (wrong): " + ", ".join(
            f"{name} {shown(value)}" for name, value in zip(naive.law.constants, naive.constants)))
    at, share = length_laws.kaplan_meier(seen)
    if len(at):
        law, constants = one.length.law, one.length.constants
        fitted = law.survival(constants, at) / law.survival(constants, np.array([seen.shortest]))
        lines.append(f"  Kaplan and Meier's curve and the first law differ by {shown(np.abs(share - fitted).max())} at most")
    return "\n".join(lines)


def poles_of(options):
    """Fisher's law of --poles, or None."""
    place = {name: number_in(options, name, low, high)
             for name, low, high in (("azimuth", 0, 360), ("scanline-trend", 0, 360), ("scanline-plunge", -90, 90))}
    line = [place["scanline-trend"], place["scanline-plunge"]]
    if not options.get("poles"):
        if any(value is not None for value in place.values()):
            raise NotWanted("--azimuth, --scanline-trend and --scanline-plunge go with --poles")
        return None
    if (line[0] is None) != (line[1] is None) or (line[0] is not None and place["azimuth"] is not None):
        raise NotWanted("expected --azimuth (poles of traces in the section), or both --scanline-trend and --scanline-plunge, or none")
    normals, weight = orientation_laws.read_poles(options["poles"])
    if line[0] is not None:
        weight = weight / orientation_laws.met_by_scanline(normals, *line)
    elif place["azimuth"] is not None:
        weight = weight / orientation_laws.met_by_section(normals, place["azimuth"])
    return orientation_laws.fisher(normals, weight, options["poles"])


def run(source, options, programs, version):
    """Fits the sets of a file of traces, and writes them as [[joint_set]]."""
    output, to_file = pathlib.Path(options["output"]), options["output"] != files.STANDARD_OUTPUT
    inputs = [source, *(pathlib.Path(options[name]) for name in ("poles", "window") if options.get(name))]
    if to_file and any(path.exists() and output.exists() and path.samefile(output) for path in inputs):
        raise NotWanted(f"-o {output} is the same file as an input; give it another name")
    files.refuse_partial(output, inputs)
    if not options.get("window"):
        raise NotWanted("fit needs --window: x1,y1,x2,y2 in metres, or a scene file whose outline it is")
    if not source.exists():
        raise NotWanted(f"{source}: there is no such file")
    window = traces.window_of(options["window"])
    shortest, longest, edge = (number_in(options, name, 0, 1e6) for name in ("shortest", "longest", "edge"))
    if (longest or 0) <= (shortest or 0) and longest is not None:
        raise NotWanted(f"--longest is {longest:g}; expected more than --shortest")
    words = [law.word for law in length_laws.laws(1, 2)]
    if options.get("law") and options["law"] not in words:
        raise NotWanted(f'--law is "{options["law"]}"; expected one of: {", ".join(words)}')
    poles = poles_of(options)
    found = traces.read(source, programs, options.get("layer"), options.get("property"))
    if poles and len(found) > 1:
        raise NotWanted("--poles are of one set; leave out --property, or take a file of one set")
    sets = [Set(value or options.get("name") or source.stem, traces.Seen(window, *ends, edge or 0.0, shortest or 0.0), shortest,
                longest, options.get("law")) for value, ends in found.items()]
    head = (f"# Fitted by jointcreep {version} to {source.name}, window {options['window']}"
            f"{f', traces from {shortest:g} m on' if shortest else ''}. Laws are those of all joints, not of those in the window.\n")
    material = options.get("material") or "joint"
    files.write_output(options["output"], head + "\n" + "\n".join(set_text(one, material, poles) for one in sets))
    if to_file and not options.get("quiet"):
        print("\n".join(summary(one) for one in sets))
    return 0
