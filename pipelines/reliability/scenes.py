"""Random legal scenes through the whole chain.

A result has to pass jointverify. A scene that is refused, or has no equilibrium, has to say so by a message of the program
(exit code 2 or 3); what is kept of a run without equilibrium has to pass, too. Each program has LONGEST seconds of the processor.
"""

import shutil

from campaign import HANGS, Campaign, ended
from random_scene import random_scene

ENERGY = "the energy balance of the dynamic analysis is off"  # a run without equilibrium that says so is refused by name
WRONG = "the result is wrong"
LONGEST = 1200  # s of the processor; a run that takes longer hangs


def trial(campaign, case, folder):
    """Outcome, and what was said."""
    scene = folder / "scene.toml"
    scene.write_text(random_scene(campaign.random(case)))
    source = scene
    for program, name in (("jointgen", "network.h5"), ("strength-averaging", "joints.h5"), ("demsolve", "result.h5")):
        output = folder / name
        done = ended([campaign.programs / program, source, "-o", output, "-q"], LONGEST)
        if done.code == HANGS:
            return "hangs", f"{program}: {done}"
        if done.code not in (0, 2, 3) or done.code and not done.is_refusal(program, (2, 3)):
            return "ends otherwise", f"{program}: {done}"
        if output.exists() != (done.code == 0):
            return "ends otherwise", f"{program}, exit code {done.code}, and its output is {'' if done.code else 'not '}there"
        if done.code == 2:
            return "refused", done.err
        if WRONG in done.err:  # a guard says so; a false alarm is a fault, too
            return "guard failed", f"{program}: {done}"
        if done.code == 3:
            output = folder / "result.failed.h5"
        source = output
    verified = ended([campaign.programs / "jointverify", source], LONGEST)
    if verified.code and done.code == 3 and ENERGY in done.err:
        return "refused", done.err
    if verified.code:
        lines = [line for line in verified.out.splitlines() if "FAILED" in line]
        return "not verified", "\n".join([str(verified), *lines])
    return ("verified" if done.code == 0 else "no equilibrium, verified"), done.err


def kind(text):
    """What the scenes are counted by."""
    if "[large_displacements]" in text:
        return "large displacements" + (", creep" if "[creep]" in text else "")
    return ("quadratic zones" if "quadratic" in text else "constant strain") + (", creep" if "[creep]" in text else "")


def body(campaign):
    for case in range(campaign.n):
        folder = campaign.chain.new_folder()
        outcome, said = trial(campaign, case, folder)
        campaign.count(kind((folder / "scene.toml").read_text()), outcome, case, said, folder)
        shutil.rmtree(folder)


if __name__ == "__main__":
    OUTCOMES = ["verified", "no equilibrium, verified", "refused", "not verified", "guard failed", "ends otherwise", "hangs"]
    Campaign("scenes with", OUTCOMES, OUTCOMES[3:], 1000).run(body)
