"""From a case to what is handed over: its section's law, its masses, its outline."""

from __future__ import annotations

import hashlib
import json
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section
from fiberbend.columns import UNIFORM
from fiberbend.export.section import Handed
from fiberbend.models.choice import choose_model, meshed
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.version import __version__
from geometry.mesh.centroid import winding_weights
from rod.functions import Floats
from rod.inertia import SectionMass

STATES = 21
"""Pressures from none to the case's own."""


def handed(case: Case) -> Handed:
    """What a case hands over.

    Args:
        case: of any model; its loads but for the pressure are left out.

    Raises:
        CaseError: it has no law of a section, no pressure, or zones.
    """
    alone, left_out = law_case(case)
    from fiberbend.export.law import known

    law = known(alone, STATES)
    mass, cap_mass, missing = _masses(alone)
    return Handed(
        section=law.section,
        cap=law.cap,
        mass=mass,
        cap_mass=cap_mass,
        no_mass=missing,
        length=case.actuator.length,
        cap_length=case.actuator.cap,
        outline=outline(alone),
        about={
            "title": case.title or "",
            "provenance": {
                "program": "fiberbend",
                "program_version": __version__,
                "case_sha256": digest(case),
                "case": case.resolved(),
                "law_by": alone.model,
                "left_out": left_out,
            },
            "validity": law.validity,
        },
    )


def law_case(case: Case) -> tuple[Case, list[str]]:
    """The section of a case under its pressure, and the names of the effects that are left out.

    Raises:
        CaseError: no section stands for it.
    """
    if case.zones is not None:
        text = "an export is of one section, expected a case without; export a case of each zone"
        raise CaseError([Problem("zones", text)])
    inflated = next((e for e in case.effects if e.inflation() is not None), None)
    if inflated is None:
        text = "none loads the chamber, expected effect pressure with to or angle"
        raise CaseError([Problem("effects", text)])
    model, _ = choose_model(case)
    if UNIFORM in model.fills and not case.straight:
        kept = [e for e in case.effects if e is inflated or not (e.load or e.keeps_straight())]
        alone = case.model_copy(update={"effects": tuple(kept), "model": model.name})
    else:
        alone = as_section(case, inflated)
    there = {effect.name for effect in alone.effects}
    return alone, [effect.name for effect in case.effects if effect.name not in there]


def outline(case: Case) -> Floats:
    """The outer line of a section from its centroid, (k, 2), counter-clockwise, mm."""
    mesh = meshed(case).mesh(case)
    _, centre = winding_weights(mesh)
    points = mesh.nodes[:, :2]
    if mesh.half:
        points = np.concatenate([points, points * [-1.0, 1.0]])
    found: Floats = points[ConvexHull(points).vertices] - centre
    return found


def digest(case: Case) -> str:
    """Of all that a case says."""
    return hashlib.sha256(json.dumps(case.resolved(), sort_keys=True).encode()).hexdigest()


def without_density(case: Case) -> list[str]:
    """Parts whose material has no density."""
    materials = convert.site(case).materials
    return [part for part, material in materials.items() if material.mass_density is None]


def _masses(case: Case) -> tuple[SectionMass | None, SectionMass | None, str]:
    """Of section and cap, and what to write where they are not known."""
    missing = without_density(case)
    if missing:
        keys = ", ".join(f"materials.{part}.density" for part in missing)
        return None, None, f"no density of {', '.join(missing)}; write {keys} in the case"
    from fiberbend.sectionlaw.masses import cap_mass, section_mass

    return section_mass(case), cap_mass(case), ""


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
    lines.append(f"axis         {axis['y_mm']:.3g} mm above the line of centroids")
    if not record["mass"]["known"]:
        lines.append(f"no mass: {record['mass']['missing']}")
    return lines
