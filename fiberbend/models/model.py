"""What every model answers for itself: what it supports, what it makes of a case, what it costs."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from fiberbend.case.case import Case, Mesh
from fiberbend.case.zones import path_of, zone_cases
from fiberbend.columns import ELEMENTS, RUN, SOLVED
from fiberbend.effects.effect import ZONES
from fiberbend.effects.records import MOTION, mirror_breakers
from fiberbend.models.costs.price import Price, price
from fiberbend.models.costs.size import ProblemSize as ProblemSize
from fiberbend.models.costs.size import thread_mb

if TYPE_CHECKING:
    from fem.effects.effect import Effect as Term
    from fem.kinematics.domain import Domain
    from fem.kinematics.kinematics import Kinematics
    from fem.march.frames import Frames
    from fem.march.records import State
    from fem.march.selfcontact import Rod
    from fem.scene import Scene
    from fem.solver.side_conditions import Functional
    from geometry.bodies.counts import Counts
    from geometry.mesh.data import MeshData
    from geometry.sections.size import MeshSize

    KinematicsFactory = Callable[[Domain, Iterable[str]], Kinematics]

Objection = tuple[str, str]
"""A path within a case, and what a model has against it."""


class Gauge(Protocol):
    """What a model reads off a state beside pressure, angle and energies."""

    def tip(self, state: State) -> tuple[float, float, float]:
        """x, y and z of the centroid of the tip cap's outer face, mm."""

    def columns(self, state: State) -> dict[str, float]:
        """Further columns, behind the chamber's volume."""

    def last_columns(self, state: State) -> dict[str, float]:
        """Columns at the end of the row; only at equilibria under load."""


@dataclasses.dataclass(frozen=True)
class Observables:
    """What is read off the states of a scene.

    Attributes:
        frames: rod frames of a body; None where the kinematics turns by itself.
        control: the bending angle, which loads may be driven by.
        gauge: makes the columns of the history; call it when the scene is at rest.
        rod: makes the states rods with caps, to see whether the body passes through itself.
    """

    frames: Frames | None
    control: Functional
    gauge: Callable[[], Gauge]
    rod: Callable[[], Rod]


@dataclasses.dataclass(frozen=True)
class Rung:
    """How fine a mesh is, in the words in which its error is known.

    Attributes:
        section: elements through each thickness.
        layers: elements along half a turn of a winding whose turns lie by themselves; 0: it is
            spread, or there is none, and everything is alike along the axis.
        axial: length of the elements of a body, mm; 0 of a slice that repeats.
    """

    section: int
    layers: float = 0.0
    axial: float = 0.0


class ModelKind(ABC):
    """A model of an actuator, from the cheapest closed form to the whole body."""

    name: ClassVar[str]
    """What a case calls it."""
    offers: ClassVar[frozenset[str]] = frozenset()
    """What effects may ask for, see `fiberbend.effects.effect`; nothing unless said."""
    fills: ClassVar[frozenset[str]] = frozenset({RUN})
    """Groups of columns of history.csv, see `fiberbend.columns`; others are refused."""
    line: ClassVar[str] = ""
    """Where it has no elements: its name among `fiberbend.models.closed_form.analytic_curves`."""
    ends: ClassVar[bool] = False
    """It has the caps, and the bend near them."""
    gives_blocked_force: ClassVar[bool] = False
    """Kept straight, it gives a tip force that bending freely it does not."""
    agreement: ClassVar[float]
    """Percent of the pressure for an angle within which it agrees with the section model, apart
    from what rubber does between the turns of a winding."""
    start_s: ClassVar[float]
    """Seconds of a run without elements; see `MeshedModel.start_seconds`."""
    pictures_s: ClassVar[tuple[float, float]]
    """Seconds to draw: in all, and for each state that is asked for."""
    fields_s: ClassVar[float] = 0.0
    """Seconds to write the fields of a state."""

    def elements(self) -> MeshedModel | None:
        """The model where it is one of finite elements; None for a closed form or a rod."""
        return None

    def slender(self) -> SlenderModel | None:
        """The model where it is a rod by the law of its section; None of others."""
        return None

    # --- what it supports ----------------------------------------------------------------------

    def refuses(self, case: Case) -> Iterator[Objection]:
        """What of a case it does not support: paths within the case and reasons."""
        if case.time is not None and MOTION not in self.offers:
            yield "time", "it knows states at rest only, model rod moves"
        if case.zones is None:
            yield from self._refuses_alike(case)
        elif ZONES not in self.offers:
            yield "zones", "one winding and one material of each part act all along"
        else:
            yield from self.limits_of_zones(case)
            by_zone = (
                (path_of(case, number, path), reason)
                for number, zone in enumerate(zone_cases(case, self.name))
                for path, reason in self._refuses_alike(zone)
            )
            yield from dict.fromkeys(by_zone)

    def limits_of_zones(self, case: Case) -> Iterator[Objection]:
        """What it does not support of a case with zones, each of which it supports by itself."""
        yield from ()

    def _refuses_alike(self, case: Case) -> Iterator[Objection]:
        """What it does not support of a case that is alike all along."""
        yield from self.refused_effects(case)
        yield from self.limits(case)

    def refused_effects(self, case: Case) -> Iterator[Objection]:
        """Effects that need what it does not offer."""
        for index, effect in enumerate(case.effects):
            reasons = (why for what, why in effect.needs().items() if what not in self.offers)
            for reason in reasons:
                yield f"effects.{index}.{effect.name}", reason
                break

    def limits(self, case: Case) -> Iterator[Objection]:
        """What it does not support, apart from effects."""
        yield from ()

    def leaves_out(self, case: Case) -> Iterator[Objection]:
        """What it leaves out of what it supports: a reason not to choose it, none to refuse."""
        if case.zones is not None:
            by_zone = (
                (path_of(case, number, path), reason)
                for number, zone in enumerate(zone_cases(case, self.name))
                for path, reason in self.leaves_out(zone)
            )
            yield from dict.fromkeys(by_zone)
            return
        for index, effect in enumerate(case.effects):
            if not self.offers.issuperset(effect.needs()):
                continue
            for what, text in effect.wants().items():
                if what not in self.offers:
                    yield f"effects.{index}.{effect.name}", text

    def unproven(self, case: Case) -> Iterator[Objection]:
        """Where nobody has put it beside a dearer model: a reason not to choose it, no doubt."""
        yield from ()

    # --- what it makes of a case ---------------------------------------------------------------

    def origin(self, case: Case) -> float:
        """z on the actuator where its mesh begins, mm: that of a slice that repeats."""
        return 0.0

    def completed(self, case: Case) -> Case:
        """The case with the defaults that depend on the model."""
        return case

    def half(self, case: Case) -> tuple[bool, str]:
        """Whether half the section, x ≥ 0, stands for the whole, and the reason."""
        if case.mesh.symmetry != "auto":
            return case.mesh.symmetry == "half", "given in the case"
        breakers = list(mirror_breakers(case.acting))
        if breakers:
            return False, "; ".join(breakers)
        return True, "section, winding and loads are mirror-symmetric about x = 0"

    def unused(self, case: Case) -> dict[str, set[str]]:
        """Settings that the case gives and the model has no use for, by part of the case."""
        return {}

    def resolved_bulging(self, case: Case) -> float:
        """Part of the bulging between the turns of a winding that it gives: 1 all, 0 nothing."""
        turns = case.turns
        return 1.0 if self.elements() is not None and turns is not None and turns.bulges else 0.0

    def hardly_sees(self, case: Case) -> Iterator[Objection]:
        """Settings whose change moves its answer little or not at all: paths and reasons."""
        for part, names in self.unused(case).items():
            yield from ((f"{part}.{name}", "it has no use for it") for name in sorted(names))
        yield from self.leaves_out(case)
        if not self.ends:
            yield "actuator.cap", "it has no caps; a cap is no more than a lever of the tip force"
        resolved = self.resolved_bulging(case) > 0
        for index, effect in enumerate(case.effects):
            for key, reason in effect.hardly_felt(resolved).items():
                yield f"effects.{index}.{effect.name}.{key}", reason

    def force_named(self) -> str:
        """What its force of a blocked tip is, in a table or a legend."""
        return f"{self.name} model"

    def force_remark(self) -> str:
        """How that force compares with a body's, with its source; empty where it is one."""
        return ""

    def errors(self, case: Case) -> Iterator[str]:
        """How far its answer is expected to be off, a line with its source each."""
        yield from ()

    def errors_of_zones(self) -> Iterator[str]:
        """How far zones beside each other are expected to be off, with the source."""
        yield from ()


class SlenderModel(ModelKind):
    """A model of a rod: pieces along a line, by laws of their sections."""

    turn: ClassVar[float]
    """Greatest change of the angle in a step, rad."""
    pieces: ClassVar[int]
    """Between the caps, of equal lengths."""
    cap_pieces: ClassVar[int]
    """In each cap."""
    step_s: ClassVar[float]
    """Seconds a step."""

    def slender(self) -> SlenderModel:
        """The model itself."""
        return self

    @abstractmethod
    def unknowns(self, case: Case) -> int:
        """Strains of all pieces."""

    @abstractmethod
    def law_seconds(self, case: Case) -> float:
        """Seconds for the law of its section where no table of it is kept yet."""


class MeshedModel(ModelKind):
    """A model of finite elements."""

    fills = frozenset({RUN, SOLVED, ELEMENTS})
    shared: ClassVar[bool] = False
    """All ranks solve it together; else one rank does."""
    resumes: ClassVar[bool] = False
    """Its runs leave a checkpoint after every step."""
    takes_mesh_as_given: ClassVar[bool] = False
    """Its elements are those that `mesh` names, whatever else the case has."""
    turn: ClassVar[float]
    """Greatest change of the angle in a step, rad: fine curves where steps are cheap."""
    first_turn: ClassVar[float]
    """The same for the first step."""
    guided_turn: ClassVar[float]
    """Greatest change of the angle in a step that the section's states guide, rad, of a body."""
    guided_first: ClassVar[float]
    """The same for the first step, from which the ends are learnt."""
    guided_growth: ClassVar[float]
    """Times that such a step may be longer than the one before."""
    memory: ClassVar[int]
    """States from which a step is extrapolated: more where steps are short."""
    straight_start: ClassVar[float]
    """Share of the load in the first step of an actuator that is kept straight."""
    priced: ClassVar[str]
    """The model whose prices are its own, see `fiberbend.models.costs.price`."""
    compile_s: ClassVar[float]
    """Seconds to compile a scene that is not in the cache."""
    layers_a_pitch: ClassVar[float] = 0.0
    """Elements along a turn of a winding that it needs to resolve it; 0 where it never does."""

    def elements(self) -> MeshedModel:
        """The model itself."""
        return self

    def steps_of_zones(self, case: Case) -> int | None:
        """Load steps of a case with zones; None where they cannot be predicted."""
        return None

    def repeats(self, case: Case) -> bool:
        """Whether its mesh is one section or slice that goes on alike along the axis.

        Zones are put together in space: the run leaves the mesh of the whole length.
        """
        return not self.ends and case.zones is None

    @abstractmethod
    def mesh_size(self, case: Case, half: bool) -> MeshSize:
        """Fineness of its mesh, of x ≥ 0 only or of all."""

    @abstractmethod
    def mesh(self, case: Case, msh: Path | None = None) -> MeshData:
        """Its mesh; a body leaves the file of gmsh at `msh`.

        Raises:
            MeshError: gmsh failed.
        """

    @abstractmethod
    def kinematics(self, case: Case) -> KinematicsFactory:
        """Its kinematics, to be made from a domain and the names of the fields."""

    @abstractmethod
    def supports(self, case: Case, mesh: MeshData) -> list[Term]:
        """Its supports: the clamp of a body, planes and axes of symmetry."""

    @abstractmethod
    def observables(self, case: Case, scene: Scene) -> Observables:
        """What is read off the states of its scene."""

    @abstractmethod
    def size(self, case: Case) -> ProblemSize:
        """How large its problem is, from the block layout: neither gmsh nor a solver starts."""

    def price(self, size: ProblemSize) -> Price:
        """What a problem takes, as `make times` has measured."""
        return price(self.priced, size.kind)

    def start_seconds(self, size: ProblemSize) -> float:
        """Seconds beside the steps, kernels compiled.

        To import, to mesh, to load kernels, for the section that guides a body, and for the answer.
        """
        return self.price(size).start_seconds(size.elements, size.unknowns, size.layers)

    def step_seconds(self, case: Case, size: ProblemSize) -> float:
        """Seconds a step on one rank."""
        return self.price(size).step_seconds(size.elements, size.unknowns, size.layers)

    def memory_mb(self, size: ProblemSize) -> float:
        """Greatest memory on one rank, MB."""
        found = self.price(size).memory_mb(size.unknowns, size.layers)
        return found + thread_mb(size.segments)

    def ladder(self, case: Case) -> Iterator[dict[str, Any]]:
        """Settings of `mesh` that an accuracy may choose among; none unless said."""
        yield from ()

    def rung(self, case: Case) -> Rung | None:
        """How fine its mesh is; None where nothing is known of the error of such meshes."""
        return None

    def drawn(self, case: Case, size: ProblemSize) -> float:
        """Elements in space that pictures and fields show."""
        return float(size.elements)

    def largest_turn(self, case: Case) -> float:
        """Greatest change of the angle in a step, rad."""
        return self.bounded_turn(case, case.solver.max_turn or self.turn)

    def bounded_turn(self, case: Case, turn: float) -> float:
        """A change of the angle in a step, rad, or the greatest that the case's effects allow."""
        length, cap = case.actuator.length, case.actuator.cap
        return min(turn, *(effect.largest_turn(length, cap) for effect in case.acting))


def completed_mesh(mesh: Mesh, **defaults: Any) -> Mesh:
    """Mesh settings with defaults where the case has no value."""
    new = {name: value for name, value in defaults.items() if name not in mesh.model_fields_set}
    return mesh.model_copy(update=new)


def count(counts: Counts, components: int, pressures: int) -> int:
    """Unknowns: quadratic displacement, linear pressure.

    Args:
        counts: of quadrilaterals or hexahedra, or of tetrahedra.
        components: of the displacement.
        pressures: an element's own; 0: those of tetrahedra, which share them in a region.
    """
    constraints = pressures * counts.cells if pressures else counts.pressures
    return components * counts.nodes + constraints


def found_pressure(case: Case) -> tuple[str, ...]:
    """The pressure among the unknowns, where something else is given."""
    load = case.inflation
    return ("pressure",) if load is not None and load.to is None else ()
