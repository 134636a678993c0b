"""States of the section model that guide the march of a body."""

from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from fem.kinematics.uniform import CURVATURE, STRETCH
from fem.march.frames import Frames
from fem.march.guide import Guide
from fem.march.hooks import AfterStep
from fem.march.records import State, measure
from fem.scene import Scene
from fem.solver.newton import Outcome
from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section
from fiberbend.effects.pressure import inflate
from fiberbend.models.choice import meshed
from fiberbend.models.result import Curve
from fiberbend.running.assembly import assemble

Floats = npt.NDArray[np.float64]

PRESSURE = "pressure"
BEYOND = 1.15
"""The section goes so much further than the angle that ends a run: a body differs a little."""


@dataclasses.dataclass(frozen=True)
class SectionStates:
    """m states of a section with n nodes, from rest on.

    Attributes:
        nodes: of its mesh, (n, 2), mm.
        measures: by name, what a march may drive, of the whole actuator, (m,).
        curvature: k, 1/mm, (m,).
        stretch: λ0, (m,).
        displacement: u and v, mm, (m, n, 2).
        bending: pressure, angle and volume of the whole actuator.
    """

    nodes: Floats
    measures: dict[str, Floats]
    curvature: Floats
    stretch: Floats
    displacement: Floats
    bending: Curve

    def guide(self, scene: Scene, frames: Frames, length: float) -> Guide:
        """The guide of a body.

        Args:
            scene: of the body.
            frames: its rod frames.
            length: of the chamber, mm.
        """
        measures = {}
        for name, values in self.measures.items():
            share = scene.body.symmetry_factor if name.startswith("conjugate") else 1.0
            measures[name] = values / share
        return Guide(
            scene.body,
            frames,
            length,
            self.nodes,
            measures,
            self.curvature,
            self.stretch,
            self.displacement,
        )


def section_states(case: Case) -> SectionStates | None:
    """March the section of a case through the case's load; on one rank.

    Args:
        case: a case for which `fiberbend.case.section_beside.section_guides` is true.

    Returns:
        The states; None where the section has too few converged steps.
    """
    load = next(effect for effect in case.effects if effect.inflation() is not None)
    inflation = load.inflation()
    if inflation is not None and inflation.angle is not None:
        load = inflate(angle=BEYOND * inflation.angle)
    section = as_section(case, load)
    stop = case.output.stop_at_angle
    if stop is not None and inflation is not None and inflation.angle is None:
        output = section.output.model_copy(update={"stop_at_angle": BEYOND * stop})
        section = section.model_copy(update={"output": output})
    states: list[State] = []

    def keep(state: State, _outcome: Outcome) -> None:
        states.append(state)

    mesh = meshed(section).mesh(section)
    assembly = assemble(section, mesh, MPI.COMM_SELF)
    states.append(assembly.march.rest)
    assembly.march.run(assembly.ramps, [AfterStep(keep)])
    if len(states) < 4:
        return None
    symmetry_factor = assembly.scene.body.symmetry_factor
    names = [measure(kind, PRESSURE) for kind in ("value", "control", "conjugate")]
    measures = {}
    for name in names:
        values = np.array([state.measures[name] for state in states])
        if abs(np.sum(np.sign(np.diff(values)))) == len(values) - 1:
            measures[name] = values * (symmetry_factor if name.startswith("conjugate") else 1.0)
    dofs = assembly.scene.body.node_dofs
    pressure, angle, volume = (
        np.array([state.measures[name] for state in states]) for name in names
    )
    return SectionStates(
        mesh.nodes,
        measures,
        np.array([state.scalars[CURVATURE] for state in states]),
        np.array([state.scalars[STRETCH] for state in states]),
        np.array([state.w[dofs] for state in states]),
        Curve(pressure, angle, symmetry_factor * volume),
    )
