"""A case on a mesh, ready to march."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from mpi4py import MPI

from fem.kinematics.domain import Domain
from fem.march.march import March
from fem.march.records import Ramp, Rules, State
from fem.results.diagnosis import Diagnosis
from fem.scene import Scene
from fem.solver.newton import Newton, Outcome, Settings
from fiberbend.case.case import Case
from fiberbend.effects import contact
from fiberbend.effects.table import ContactEffect
from fiberbend.models import kinds
from fiberbend.models.choice import FIRST_TURN, MEMORY, turn_of
from fiberbend.models.parts import Parts, build
from fiberbend.running.approach import Approach
from geometry.mesh.data import MeshData


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
    on_step: Callable[[State, Outcome], None],
    warn: Callable[[str], None],
) -> Assembly:
    """Compile a case and put it at rest; collective.

    Args:
        case: the case.
        model: "section", "cell" or "body".
        mesh: its mesh.
        comm: communicator.
        on_step: called after every converged step.
        warn: called with a line where a step fails.
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
    march = March(scene, newton, reading.frames, reading.followed, rules, on_step, warn)
    march.causes = Diagnosis(scene)
    march.start()
    ramps = parts.ramps(scene.body.copies)
    if case.find(ContactEffect) is not None:
        Approach(scene, march, ramps)
    return Assembly(parts, scene, reading, newton, march, ramps)
