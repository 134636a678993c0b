"""What every effect of a case answers for itself. An answer that it does not give refuses."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Self

from fiberbend.effects.records import (
    ARC,
    CHAMBER,
    ENDS,
    HELD,
    HOOPS,
    SIDE,
    SPACE,
    STRIPS,
    THREAD,
    TURNS,
    TWIST,
    VOLUME,
    WOUND,
    ZONES,
    Built,
    Draft,
    Inflation,
    OnRod,
    Requests,
    RodSite,
    Site,
    Stretch,
)
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import Spec

if TYPE_CHECKING:
    from fem.march.records import Rules
    from fem.solver.newton import Settings
    from fiberbend.effects.wound.turns import Turns
    from fiberbend.states.obstacles import Shape
    from fiberbend.states.snapshot import FamilyLook
    from geometry.actuator import Actuator
    from geometry.mesh.data import Floats, MeshData
    from geometry.sections.size import MeshSize, Strips
    from geometry.winding.strip import Window
    from materials.bedding import Bedding
    from materials.bulging import Bulging

__all__ = [
    "ARC",
    "CHAMBER",
    "ENDS",
    "HELD",
    "HOOPS",
    "SIDE",
    "SPACE",
    "STRIPS",
    "THREAD",
    "TURNS",
    "TWIST",
    "VOLUME",
    "WOUND",
    "ZONES",
    "Built",
    "Draft",
    "Effect",
    "Inflation",
    "Requests",
    "Site",
    "Stretch",
    "keep_straight",
]


class Effect(Spec):
    """One effect of a case: its settings, and all that the program asks of it.

    A phase of the program asks these questions of every effect and names none. Whoever adds
    an effect answers those that concern it. The answers given here refuse: only a body in space
    can have the effect, without symmetry, without a cheaper model beside it.
    """

    name: ClassVar[str]
    """The key under which a case lists it."""
    load: ClassVar[bool] = False
    """True where the march has something to ramp."""
    several: ClassVar[bool] = False
    """True where a case may list it more than once."""
    needs_density: ClassVar[bool] = False
    """True where it needs the density of every material."""

    # --- which model supports it ---------------------------------------------------------------

    def needs(self) -> dict[str, str]:
        """What a model must offer to support this effect, each with why it is needed."""
        return {SPACE: f"only a body in space is known to support {self.name}"}

    def wants(self) -> dict[str, str]:
        """What a model must offer to support it in full, each with what is left out otherwise."""
        return {}

    def mirror_breaker(self) -> str:
        """Why x = 0 is no mirror plane of it; empty where it is one."""
        return f"{self.name} is not known to be mirror-symmetric"

    def end_breaker(self) -> str:
        """Why z = 0, and with it others along the axis, is no mirror plane of it; empty: it is.

        Without that plane a body that bends uniformly may twist, and its sections may warp.
        """
        return f"{self.name} is not known to be alike forward and backward"

    def turn_breaker(self) -> str:
        """Why half a turn about y does not map it onto itself; empty where it does.

        Where neither that turn nor the mirror planes do, a body that bends uniformly may bend to
        the side.
        """
        return f"{self.name} is not known to be its own image by half a turn about y"

    def slackens(self) -> bool:
        """Whether parts of it bear tension alone and go slack one after another."""
        return False

    def bends(self) -> bool:
        """Whether it may bend an actuator that is alike above and below."""
        return True

    # --- its settings --------------------------------------------------------------------------

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """What is wrong with it, other parts of the case known.

        Args:
            path: of this effect.
            draft: what else of the case is valid.
        """
        yield from ()

    def hardly_felt(self, resolved: bool) -> dict[str, str]:
        """Settings of it whose change moves an answer little or not at all, each with the reason.

        Args:
            resolved: the model resolves the turns of a winding.
        """
        return {}

    def in_turns(self) -> dict[str, Any]:
        """Settings with which a winding has its turns, where it has none yet."""
        return {}

    def completed(self, offers: frozenset[str] | None) -> Self:
        """The effect with its defaults.

        Args:
            offers: what the model of the case offers; None where the model is still to be chosen.
        """
        return self

    def representations(self) -> tuple[Self, ...]:
        """The effect in every form in which the case leaves it to a model, the roughest first."""
        return (self,)

    def unresolved(self, size: MeshSize) -> Iterator[tuple[str, str]]:
        """What of it a mesh is too coarse to feel.

        Args:
            size: fineness of the mesh.

        Yields:
            A key of this effect, and a message with what the mesh needs.
        """
        yield from ()

    # --- what it is to the rest of the program ---------------------------------------------------

    def inflation(self) -> Inflation | None:
        """How it loads the chamber; None where it does not."""
        return None

    def weight(self) -> tuple[float, float, float] | None:
        """Acceleration by which it makes everything heavy, mm/s²; None where it does not."""
        return None

    def winds(self) -> bool:
        """Whether it winds thread around the body."""
        return False

    def turns(self, actuator: Actuator) -> Turns | None:
        """The thread that it winds around the body; None where it winds none."""
        return None

    def runs(self, actuator: Actuator) -> list[str]:
        """How its thread runs, a line for each family of it; may be empty."""
        return []

    def looks(self, actuator: Actuator) -> list[FamilyLook]:
        """Its families of threads as pictures tell them apart; may be empty."""
        return []

    def fixes_circumference(self) -> bool:
        """Whether it fixes the circumference of the section, as the closed form assumes."""
        return False

    def assumed(self) -> Iterator[str]:
        """What the closed form assumes of it, one sentence each."""
        yield from ()

    def keeps_straight(self) -> bool:
        """Whether it keeps the actuator from bending: the force is asked for, not the angle."""
        return False

    def strips(self) -> Strips | None:
        """Strips of the surface that a mesh must show for it."""
        return None

    def fixes_angle(self) -> bool:
        """Whether it holds the bending angle, so that no load can reach one."""
        return "curvature" in self.fixed_scalars()

    def held(self) -> dict[str, str]:
        """Motions that it holds along the whole length, by their columns, and at what, in words."""
        return {}

    def fixed_scalars(self) -> tuple[str, ...]:
        """Global unknowns of uniform bending that it fixes."""
        return ()

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """What it adds to the error of a body, a line with its source each.

        Args:
            straight: some effect keeps the actuator from bending.
        """
        yield f"{self.name}: what it adds to the error is not known"

    def obstacle_shapes(self, actuator: Actuator) -> dict[str, Shape]:
        """Rigid obstacles that it places, by their names, as pictures show them."""
        return {}

    def obstacle_forces(self, row: Mapping[str, Any]) -> dict[str, tuple[float, float, float]]:
        """Forces of its obstacles on the body, x, y and z in N, from a row of the history.

        Obstacles are named as in `obstacle_shapes`; those whose force is not known are left out.
        """
        return {}

    def at_tip(self, row: Mapping[str, Any]) -> dict[str, tuple[float, float, float] | None]:
        """What acts at the tip's outer face, by what pictures call it: its force in N.

        Args:
            row: of the history; None stands for a force whose direction is not known.
        """
        return {}

    def windows(self, actuator: Actuator) -> list[Window]:
        """Parts of the outline that it covers with fabric, as pictures show them."""
        return []

    def curves(self, actuator: Actuator) -> list[Floats]:
        """Polylines in space, (n, 3), mm, that are to be seen in the mesh file."""
        return []

    def follows_section(self) -> bool:
        """Whether a body with it bends, between its ends, as the section solved beside it."""
        return False

    def beside(self) -> Effect | None:
        """What stands for it in the section that is solved beside a case; None: left out."""
        return None

    def spread(self) -> Effect:
        """The same without what waits for a calibration, or is made by one."""
        return self

    def uncalibrated(self) -> bool:
        """Whether it waits for numbers that the cell of its section gives."""
        return False

    def bulges(self) -> Bulging | Bedding | None:
        """How stiff rubber is that bulges between its turns; None where that is not given."""
        return None

    def in_cell(self) -> Effect | None:
        """What stands for it in the cell by which a winding is calibrated; None: left out."""
        return None

    def with_bulging(self, bulging: Bulging | Bedding) -> Effect:
        """The effect with the numbers that it waited for."""
        raise NotImplementedError(f"effect {self.name} is not calibrated")

    def not_beside(self) -> str:
        """Why no section can be solved beside a case with it; empty where one can."""
        return ""

    def alone(self) -> str:
        """What acts on the run and on no model beside it, in words; empty where nothing does."""
        return f"{self.name} acts"

    def unmeasured(self) -> str:
        """What of it the measured errors of meshes do not hold for, in words; empty: they hold."""
        return self.alone()

    def no_closed_form(self) -> str:
        """Why no closed form is drawn beside a case with it; empty where one is."""
        return ""

    # --- increment control ---------------------------------------------------------------------

    def steps(self) -> int | None:
        """Load steps that it adds to those of the chamber's load; None: cannot be predicted."""
        return None

    def touches(self) -> bool:
        """Whether surfaces come into contact during the march, which then ends a step there."""
        return False

    def largest_turn(self, length: float, cap: float) -> float:
        """Greatest change of the bending angle in a step, rad.

        Args:
            length: of the chamber, mm.
            cap: length of each cap, mm.
        """
        return math.inf

    def settings(self, usual: Settings) -> Settings:
        """Settings of Newton's method with it."""
        return usual

    def rules(self, usual: Rules, straight: bool) -> Rules:
        """Rules of the march with it; `straight`: some effect keeps the actuator straight."""
        return usual

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """The effect on a mesh.

        Args:
            site: the actuator, with the materials of its parts.
            mesh: the mesh of the model.
            requests: steps and stops that the case asks for.

        Raises:
            NotImplementedError: the effect cannot be built.
        """
        raise NotImplementedError(f"effect {self.name} cannot be built")

    def on_rod(self, site: RodSite) -> OnRod:
        """The effect on a rod; nothing of what stands in the section beside: it is in its law.

        Args:
            site: the actuator as a rod.

        Raises:
            NotImplementedError: a rod cannot have the effect.
        """
        if self.beside() is None:
            raise NotImplementedError(f"effect {self.name} is not known to act on a rod")
        return OnRod()

    def at_rods_tip(self, _weight: Any) -> tuple[float, float] | None:
        """Force, N, and moment, N mm, at a tip, heavy by an acceleration; None: not known."""
        return (0.0, 0.0) if not self.load or self.inflation() or self.weight() else None

    def of_measured(self) -> float:
        """Load over the greatest with which a rod was put beside a body; those at a tip add up."""
        return math.inf if self.load and self.inflation() is None else 0.0

    def unlike(self, other: Effect) -> str:
        """Why no mesh can have it in a zone and another of its class in the next; empty: it can."""
        return f"{self.name} is not known to differ along the length"

    def build_along(self, zones: Sequence[Stretch], requests: Requests) -> Built:
        """Effects of this kind on one mesh, each in its zone.

        Args:
            zones: those that have one, from root to tip, this effect the first of them.
            requests: as in `build`.

        Raises:
            NotImplementedError: the effect cannot differ along the length.
        """
        raise NotImplementedError(f"effect {self.name} cannot differ along the length")

    def doubts(self, site: Site, rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
        """What makes a run with it doubtful, a line each, from the rows of its history."""
        yield from ()

    def summary(self, site: Site, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
        """Entries of run.json on a body with it, from the rows of its history; may be empty."""
        return {}


def keep_straight(effects: Iterable[Effect]) -> bool:
    """Whether effects keep the actuator from bending: its force is asked for, not its angle."""
    return any(effect.keeps_straight() for effect in effects)
