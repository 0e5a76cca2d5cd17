"""How far a result file is from an exact answer, or from another result, and what it cost in equilibria.

Errors are relative to the scale of the case: displacements to the largest exact displacement at the end, tractions
to the largest exact traction at any time. Tractions are compared at every state that the file holds.
"""

import tomllib
from dataclasses import dataclass

import numpy as np

import closed_forms
import figure


@dataclass
class Result:
    """What comparing needs of a result file."""

    scene: dict
    points: list[str]
    end: float  # [day]
    displacement: np.ndarray  # [point, {x, y}] at the end [m]
    peak: np.ndarray  # the largest displacements on the way, the same shape
    time: np.ndarray  # of the states [day]
    period: np.ndarray  # of the states: how many stages there have been
    contacts: closed_forms.Contacts
    traction: np.ndarray  # [state, contact, {normal, shear}] [Pa]
    relative_displacement: np.ndarray  # the same [m]
    status: np.ndarray  # [state, contact]: 0 removed, 1 sticking, 2 slipping, 3 open
    stiffness: np.ndarray  # [contact, {normal, shear}] [Pa/m]
    zones: int
    equilibria: int  # sought in all, also with creep steps that were too long
    steps: int  # of dynamic relaxation, and corrections by the implicit engine, in all of them
    factorisations: int
    solves: int  # back-substitutions
    version: str


def stiffness_of(scene, materials):
    of = {m["name"]: [m[f"{direction}_stiffness_MPa_per_m"] * 1e6 for direction in ("normal", "shear")]
          for m in scene["joint_material"]}
    return np.array([of[name] for name in materials])


def slip_of(result):
    """Slip of the contacts of a run without creep, less that at the start [state, contact]; nan where removed or open."""
    slip = result.relative_displacement[:, :, 1] - (result.traction[:, :, 1] - result.traction[0, :, 1]) / result.stiffness[:, 1]
    return np.where((result.status == 0) | (result.status == 3), np.nan, slip)


def result_of(path):
    with figure.opened(path) as file:
        def array(name):
            return figure.array(file, name)

        scene = figure.text_of(file["/scene"][0])
        edge = array("/mesh/contact_edge")
        joint, boundary = array("/edges/joint")[edge], array("/edges/boundary")[edge]
        scene = tomllib.loads(scene)
        names = figure.texts(file, "/names/joint_material")
        materials = array("/joints/material")
        contacts = closed_forms.Contacts(
            array("/mesh/gridpoint_position")[array("/mesh/contact_gridpoint")[:, 1]],
            array("/mesh/contact_normal"), array("/mesh/contact_length"),
            [names[materials[j]] if j >= 0 else scene["boundary"][b]["joint"] for j, b in zip(joint, boundary)])
        displacement = array("/history/displacement")
        events = figure.texts(file, "/states/event")
        return Result(scene, figure.texts(file, "/history/point"), float(array("/history/time")[-1]),
                      displacement[-1], np.abs(displacement).max(axis=0), array("/states/time"),
                      np.cumsum([event != "" for event in events]), contacts, array("/states/traction"),
                      array("/states/relative_displacement"), array("/states/contact_status"), stiffness_of(scene, contacts.material),
                      len(array("/mesh/zone_block")),
                      *(int(array(f"/equilibria/{what}").sum()) for what in
                        ("searches", "steps", "factorisations", "solves")),
                      figure.text_of(file.attrs["program_version"]))


@dataclass
class Error:
    displacement: float  # at the end [-]
    traction: float  # the largest over the run [-]; not a number where contacts do not match
    traction_at_the_end: float
    metres: float = np.nan  # the larger one of displacements and of tractions over stiffness [m]


def against_closed_form(result, answer):
    exact = np.array([answer.displacement(point, result.end) for point in result.points])
    apart = np.nan_to_num(result.displacement - exact)
    moved = np.nan_to_num(exact)
    off, joints = [], 0.0
    for day, period, traction, status in zip(result.time, result.period, result.traction, result.status):
        off_by = traction - answer.traction(result.contacts, day, period)
        off.append(np.abs(off_by[status != 0]).max())
        joints = max(joints, np.abs(off_by / result.stiffness)[status != 0].max())
    return Error(np.linalg.norm(apart, axis=1).max() / np.linalg.norm(moved, axis=1).max(),
                 max(off) / answer.scale, off[-1] / answer.scale, max(joints, np.linalg.norm(apart, axis=1).max()))


def against_tractions(result, displacement, traction):
    """Against the displacements at the end [point, {x, y}] and the tractions at the result's own states."""
    off_by = np.abs((result.traction - traction) * (result.status != 0)[:, :, None])
    off = off_by.max(axis=(1, 2)) / np.abs(traction).max()
    apart = np.linalg.norm(result.displacement - displacement, axis=1).max()
    return Error(apart / np.linalg.norm(displacement, axis=1).max(), off.max(), off[-1],
                 max(apart, (off_by / result.stiffness).max()))


def against(result, reference):
    """Against another result. Between its states the reference is taken as linear in time."""
    if result.contacts.length.shape != reference.contacts.length.shape:
        traction = None
    else:
        traction = np.empty_like(result.traction)
        for state, (day, period) in enumerate(zip(result.time, result.period)):
            rows = np.flatnonzero(reference.period == period)
            after = min(np.searchsorted(reference.time[rows], day - 1e-9), len(rows) - 1)
            before = max(after - 1, 0)
            t0, t1 = reference.time[rows[before]], reference.time[rows[after]]
            part = np.clip((day - t0) / (t1 - t0), 0, 1) if t1 > t0 else 1.0
            traction[state] = (1 - part) * reference.traction[rows[before]] + part * reference.traction[rows[after]]
    if traction is None:
        apart = np.linalg.norm(result.displacement - reference.displacement, axis=1).max()
        return Error(apart / np.linalg.norm(reference.displacement, axis=1).max(), np.nan, np.nan)
    return against_tractions(result, reference.displacement, traction)
