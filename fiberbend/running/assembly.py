"""A case on a mesh, ready to march."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

from mpi4py import MPI

from fem.kinematics.domain import Domain
from fem.march.frames import Frames
from fem.march.guide import Guide
from fem.march.march import March
from fem.march.records import Ramp, Rules
from fem.results.diagnosis import Diagnosis
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from fiberbend.case.case import Case
from fiberbend.models.choice import meshed
from fiberbend.models.model import MeshedModel, Reading
from fiberbend.models.parts import Parts, build
from fiberbend.running.approach import Approach
from geometry.mesh.data import MeshData

STEERED_TURN = math.radians(90)
"""Greatest change of the angle in a step that leans on the section, unless the case says."""
STEERED_FIRST = math.radians(15)
STEERED_GROWTH = 3.0

Lead = Callable[[Scene, Frames], Guide | None]
"""Makes the shapes on which a body's march leans; None of it where there are none."""


@dataclasses.dataclass(frozen=True)
class Assembly:
    """What a march needs, at rest.

    Attributes:
        parts: effects and loads.
        scene: the compiled scene.
        reading: what is read off its states.
        newton: the solver.
        march: the load stepping.
        ramps: the loads of what is modelled.
    """

    parts: Parts
    scene: Scene
    reading: Reading
    newton: Newton
    march: March
    ramps: list[Ramp]


def assemble(
    case: Case,
    mesh: MeshData,
    comm: MPI.Comm,
    lead: Lead | None = None,
    watch: bool = False,
) -> Assembly:
    """Compile a case and put it at rest; collective.

    Args:
        case: the case.
        mesh: the mesh of its model.
        comm: communicator.
        lead: makes the guide of a body; without it there is none.
        watch: look whether the body passes through itself.
    """
    model = meshed(case)
    parts = build(case, mesh, model)
    scene = Scene(Domain(mesh, comm), parts.effects, model.kinematics(case))
    reading = model.reading(case, scene)
    settings = Settings(tolerance=case.solver.tolerance)
    for effect in case.effects:
        settings = effect.settings(settings)
    newton = Newton(scene, comm, settings)
    frames = reading.frames
    guide = None if lead is None or frames is None else lead(scene, frames)
    march = March(
        scene,
        newton,
        rules(case, model, guide is not None),
        frames=frames,
        control=reading.control,
        guide=guide,
        rod=reading.rod() if watch else None,
        causes=Diagnosis(scene),
        hooks=[Approach(scene)] if any(effect.touches() for effect in case.effects) else [],
    )
    return Assembly(parts, scene, reading, newton, march, parts.ramps(scene.body.symmetry_factor))


def rules(case: Case, model: MeshedModel, guided: bool) -> Rules:
    """Incrementation of a case.

    Args:
        case: the case.
        model: its model.
        guided: there is a guide: a short first step, from which the ends are learnt.
    """
    turn = model.largest_turn(case)
    found = Rules(
        cutbacks=case.solver.max_cutbacks,
        turn=turn,
        first_turn=min(turn, model.first_turn),
        memory=model.memory,
    )
    for effect in case.effects:
        found = effect.rules(found, case.straight)
    if not guided:
        return found
    said = case.solver.max_turn
    return dataclasses.replace(
        found,
        turn=said or STEERED_TURN,
        first_turn=said or STEERED_FIRST,
        grow=STEERED_GROWTH,
    )
