"""A case on a mesh, ready to march."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence

from mpi4py import MPI

from fem.kinematics.domain import Domain
from fem.march.frames import Frames
from fem.march.guide import Guide
from fem.march.hooks import Hook
from fem.march.march import March
from fem.march.records import Ramp, Rules
from fem.march.selfcontact import Rod
from fem.results.diagnosis import Diagnosis
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from fiberbend.case.case import Case
from fiberbend.effects import contact
from fiberbend.effects.table import ContactEffect
from fiberbend.models import kinds
from fiberbend.models.choice import FIRST_TURN, MEMORY, turn_of
from fiberbend.models.parts import Parts, build
from fiberbend.running.approach import Approach
from geometry.mesh.data import MeshData

STEERED_TURN = math.radians(90)
"""Greatest change of the angle in a step that leans on the section, unless the case says."""
STEERED_FIRST = math.radians(15)
STEERED_GROWTH = 3.0


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
    reading: kinds.Reading
    newton: Newton
    march: March
    ramps: list[Ramp]


def assemble(
    case: Case,
    model: str,
    mesh: MeshData,
    comm: MPI.Comm,
    hooks: Sequence[Hook] = (),
    rod: Callable[[Scene, Frames | None], Rod] | None = None,
    guide: Callable[[Scene, Frames], Guide | None] | None = None,
) -> Assembly:
    """Compile a case and put it at rest; collective.

    Args:
        case: the case.
        model: "section", "cell" or "body".
        mesh: its mesh.
        comm: communicator.
        hooks: what is called while the march goes on.
        rod: makes of the states rods, to see whether the body passes through itself.
        guide: makes the shapes on which a body's march leans; None of it where there are none.
    """
    parts = build(case, mesh, model)
    scene = Scene(Domain(mesh, comm), parts.effects, kinds.kinematics(case, model))
    reading = kinds.reading(case, scene)
    settings = contact.settings(case, Settings(tolerance=case.solver.tolerance))
    newton = Newton(scene, comm, settings)
    turn = turn_of(case, model)
    rules = Rules(
        cutbacks=case.solver.max_cutbacks,
        turn=turn,
        first_turn=min(turn, FIRST_TURN[model]),
        memory=MEMORY[model],
    )
    rules = contact.pace(case, rules)
    frames = reading.frames
    leads = guide(scene, frames) if guide is not None and frames is not None else None
    # what leads the march comes before what records where it stands
    approach = [Approach(scene)] if case.find(ContactEffect) is not None else []
    march = March(
        scene,
        newton,
        steered(rules, case) if leads is not None else rules,
        frames=frames,
        control=reading.control,
        guide=leads,
        rod=rod(scene, frames) if rod is not None else None,
        causes=Diagnosis(scene),
        hooks=[*approach, *hooks],
    )
    return Assembly(parts, scene, reading, newton, march, parts.ramps(scene.body.symmetry_factor))


def steered(rules: Rules, case: Case) -> Rules:
    """Rules of a march with a guide: a short first step, from which the ends are learnt."""
    turn = case.solver.max_turn
    return dataclasses.replace(
        rules,
        turn=turn or STEERED_TURN,
        first_turn=turn or STEERED_FIRST,
        grow=STEERED_GROWTH,
    )
