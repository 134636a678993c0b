"""From a case to what is handed over: its section's law, its masses, its outline."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from fiberbend.beam.kept import beam_of
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.columns import UNIFORM
from fiberbend.export.ends import KEYS, caps_of
from fiberbend.export.law import known
from fiberbend.export.section import Handed
from fiberbend.models.choice import choose_model
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.slender.beside import section_case
from fiberbend.slender.laws import masses, pulled
from fiberbend.slender.moments import Section, section_of, weighed
from fiberbend.slender.torsion import torsion
from fiberbend.version import __version__
from geometry.bodies.extrude import section_quadrilaterals
from geometry.bodies.quads import section_mesh
from geometry.sections.size import MeshSize
from geometry.sections.table import section_layout
from rod.functions import Floats

STATES = 21
"""Pressures from none to the case's own."""


def handed(case: Case, densities: Mapping[str, float], reached: float | None = None) -> Handed:
    """What a case hands over.

    Args:
        case: of any model; its loads but for the pressure are left out.
        densities: of parts whose materials have none, t/mm³.
        reached: greatest pressure that a run has reached before it ended, MPa; None: the case's.

    Raises:
        CaseError: it has no law of a section, no pressure, or zones.
    """
    alone, left_out = law_case(case)
    law, moments = known(alone, STATES, reached), section_of(case)
    heavy = weighed_case(case, densities)
    missing = without_density(heavy)
    mass, cap_mass = (None, None) if missing else masses(heavy, moments)
    cap, damped = cap_stiffness(case, moments), case.time
    beam = beam_of(alone, float(law.section.pressures[-1]))
    return Handed(
        section=law.section,
        cap=cap,
        caps=caps_of(alone, cap, float(law.section.pressures[-1])),
        retardation=0.0 if damped is None else damped.damping.retardation_time,
        mass=mass,
        cap_mass=cap_mass,
        no_mass=density_words(missing),
        length=case.actuator.length,
        cap_length=case.actuator.cap,
        outline=outline(case, moments),
        about={
            "title": case.title or "",
            "provenance": {
                "program": "fiberbend",
                "program_version": __version__,
                "case_sha256": digest(case),
                "case": case.resolved(),
                "law_by": alone.model,
                "left_out": left_out,
                "density_given_kg_per_m3": {part: 1e12 * rho for part, rho in densities.items()},
            },
            "validity": law.validity,
        },
        shear=np.array([beam.stiffness(pressure) for pressure in law.section.pressures]),
        cap_shear=beam.cap_stiffness,
        shear_centre=beam.centre,
    )


def law_case(case: Case) -> tuple[Case, list[str]]:
    """The section of a case under its pressure, and the names of what is left out: effects, `time`.

    Raises:
        CaseError: no section stands for it.
    """
    if case.zones is not None:
        text = "an export is of one section, expected a case without; export a case of each zone"
        raise CaseError([Problem("zones", text)])
    inflated = next((e for e in case.effects if e.inflation() is not None), None)
    load = None if inflated is None else inflated.inflation()
    if load is None or (load.to is None and load.angle is None) or (load.to or 1.0) < 0:
        text = "expected effect pressure with an angle, or with a pressure above zero"
        raise CaseError([Problem("effects", text)])
    held = [
        Problem(f"effects.{index}.{effect.name}", "holds a motion, which no section does by itself")
        for index, effect in enumerate(case.effects)
        if effect.fixed_scalars() and not effect.keeps_straight()
    ]
    if held:
        raise CaseError(held)
    model, _ = choose_model(case)
    if UNIFORM in model.fills:
        kept = [e for e in case.effects if e is inflated or not (e.load or e.keeps_straight())]
        alone = case.model_copy(update={"effects": tuple(kept), "model": model.name})
    else:
        alone = section_case(case)
    there = {effect.name for effect in alone.effects}
    left_out = [effect.name for effect in case.effects if effect.name not in there]
    return alone, left_out if case.time is None else [*left_out, "time"]


def cap_stiffness(case: Case, moments: Section) -> Floats:
    """Of a solid cap of its materials at rest, (4, 4): N, N mm, N mm²."""
    materials = convert.site(case).materials
    sums = weighed(
        moments.filled, {name: float(pulled(each)[0]) for name, each in materials.items()}
    )
    # the stretch at x, y is λ + k_x y − k_y x
    by = np.array([(0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)])
    out = np.zeros((4, 4))
    out[:3, :3] = by @ (sums + sums.T) / 2 @ by.T
    layout = section_layout(convert.dimensions(case.actuator), MeshSize(section=2, half=False))
    shear = {name: each.initial_shear_modulus for name, each in materials.items()}
    out[3, 3] = torsion(section_mesh(layout), shear)
    return out


def outline(case: Case, moments: Section) -> Floats:
    """The outer line of a section from its centroid, (k, 2), counter-clockwise, mm."""
    points = section_quadrilaterals(
        convert.dimensions(case.actuator), MeshSize(section=2, half=False)
    ).nodes
    found: Floats = points[ConvexHull(points).vertices] - [0.0, moments.height]
    return found


def weighed_case(case: Case, densities: Mapping[str, float]) -> Case:
    """The case with densities of its parts, t/mm³."""
    specs = {
        part: getattr(case.materials, part).model_copy(update={"density": density})
        for part, density in densities.items()
    }
    return case.model_copy(update={"materials": case.materials.model_copy(update=specs)})


def digest(case: Case) -> str:
    """Of all that a case says."""
    return hashlib.sha256(json.dumps(case.resolved(), sort_keys=True).encode()).hexdigest()


def without_density(case: Case) -> list[str]:
    """Parts whose material has no density."""
    materials = convert.site(case).materials
    return [part for part, material in materials.items() if material.mass_density is None]


def density_words(missing: list[str]) -> str:
    """What to write where parts have no density; empty where all have one."""
    if not missing:
        return ""
    options = " ".join(f'--density {part}="1.1 g/cm^3"' for part in missing)
    return f"no density of {', '.join(missing)} is known, expected such as {options}"


def facts(record: dict[str, Any]) -> list[str]:
    """What a file says, in lines for the terminal."""
    section, axis = record["section"], record["axis"]
    kpa = section["pressure_kPa"]
    lines = [f"pressure     {kpa[0]:.4g} to {kpa[-1]:.4g} kPa, {len(kpa)} states"]
    bend = np.array(axis["rest_curvature_1_per_mm"]) * 1e3
    lines.append(f"curvature    {bend[0]:.4g} to {bend[-1]:.4g} 1/m without load")
    own = np.array(axis["bending_stiffness_N_mm2"])
    for name, place in (("bending", 0), ("side bending", 1), ("twisting", 2)):
        row = own[:, place, place]
        lines.append(f"{name:12} {row.min():.4g} to {row.max():.4g} N mm²")
    axial = np.array(axis["axial_stiffness_N"])
    lines.append(f"stretching   {axial.min():.4g} to {axial.max():.4g} N")
    beside = "below" if axis["y_mm"] < 0 else "above"
    bent, twisted = (
        np.degrees(sum(record["ends"][key][name][-1] for key in KEYS))
        for name in ("turn_rad", "twist_rad")
    )
    twist = f" and {twisted:.3g}° about the line" if twisted else ""
    lines.append(f"ends         {bent:.3g}°{twist} by the greatest pressure, caps included")
    lines.append(f"axis         {abs(axis['y_mm']):.3g} mm {beside} the line of centroids")
    if not record["mass"]["known"]:
        lines.append(f"no mass: {record['mass']['missing']}")
    return lines
