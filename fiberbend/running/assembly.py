"""A case on a mesh, ready to march."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from mpi4py import MPI

from fem.kinematics.domain import Domain
from fem.march.frames import Frames
from fem.march.guide import Guide
from fem.march.march import March
from fem.march.records import Ramp, Rules
from fem.results.diagnosis import Diagnosis
from fem.results.walls import Walls
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.models.choice import meshed
from fiberbend.models.model import MeshedModel, Observables
from fiberbend.models.parts import SceneParts, build
from fiberbend.running.approach import Approach
from fiberbend.states.snapshot import ModelMesh
from geometry.mesh.data import MeshData

GuideFactory = Callable[[Scene, Frames], Guide | None]
"""Makes the guide of a body's march; None where there is none."""


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
        walls: sees whether walls of the chamber pass through each other; None: not looked.
    """

    parts: SceneParts
    scene: Scene
    observables: Observables
    newton: Newton
    march: March
    ramps: list[Ramp]
    walls: Walls | None = None

    def model_mesh(self, case: Case) -> ModelMesh:
        """Mesh, materials and fibers as files and pictures show them."""
        return ModelMesh(
            mesh=self.scene.domain.data,
            materials=self.parts.materials,
            fibers=self.parts.fibers,
            smeared=self.parts.smeared,
            title=case.title,
            uniform=meshed(case).repeats(case),
            families=convert.looks(case),
        )


def without_symmetry(case: Case) -> Case:
    """The case without a mirror plane."""
    return case.model_copy(update={"mesh": case.mesh.model_copy(update={"symmetry": "full"})})


def assemble(
    case: Case,
    mesh: MeshData,
    comm: MPI.Comm,
    make_guide: GuideFactory | None = None,
    watch: bool = False,
) -> Assembly:
    """Compile a case and put it at rest; collective.

    Args:
        case: the case.
        mesh: the mesh of its model.
        comm: communicator.
        make_guide: makes the guide of a body; None for no guide.
        watch: look whether the body, or its chamber's wall, passes through itself.
    """
    model = meshed(case)
    parts = build(case, mesh, model)
    scene = Scene(Domain(mesh, comm), parts.effects, model.kinematics(case))
    observables = model.observables(case, scene)
    settings = Settings(
        tolerance=case.solver.tolerance,
        # sections and cells are too small to be shared
        iterative=model.shared and case.solver.linear == "iterative",
    )
    for effect in case.acting:
        settings = effect.settings(settings)
    newton = Newton(scene, comm, settings)
    frames = observables.frames
    walls = Walls(scene) if watch else None
    touching = [Approach(scene)] if any(effect.touches() for effect in case.acting) else []
    guide = None if make_guide is None or frames is None else make_guide(scene, frames)
    march = March(
        scene,
        newton,
        rules(case, model, guide is not None),
        frames=frames,
        control=observables.control,
        guide=guide,
        rod=observables.rod() if watch else None,
        causes=Diagnosis(scene),
        hooks=[*touching, *([walls] if walls else [])],
    )
    ramps = parts.ramps(scene.body.symmetry_factor)
    return Assembly(parts, scene, observables, newton, march, ramps, walls)


def rules(case: Case, model: MeshedModel, guided: bool) -> Rules:
    """Incrementation of a case.

    Args:
        case: the case.
        model: its model.
        guided: there is a guide: a short first step, from which the ends are learnt.
    """
    turn, first, given = model.turn, model.first_turn, case.solver.max_turn
    if guided:
        turn, first = model.guided_turn, given or model.guided_first
    turn = model.bounded_turn(case, given or turn)
    found = Rules(
        cutbacks=case.solver.max_cutbacks,
        turn=turn,
        first_turn=min(turn, first),
        memory=model.memory,
    )
    if guided:
        found = dataclasses.replace(found, grow=model.guided_growth)
    for effect in case.acting:
        found = effect.rules(found, case.straight)
    return found
