"""What effects and models tell each other: words for what a model offers, and small records."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fem.effects.effect import Effect as Term
    from fem.march.records import Ramp
    from fiberbend.effects.effect import Effect
    from geometry.actuator import Actuator
    from geometry.mesh.data import Floats, MeshData
    from geometry.sections.shape import ShapedActuator
    from geometry.sections.size import Strips
    from geometry.winding.segments import EmbeddedFibers
    from materials.material import Material
    from rod.contact.touch import Touch
    from rod.layout import Layout
    from rod.term import Term as RodTerm

CHAMBER = "chamber"
"""A model has the chamber that a pressure inflates."""
WOUND = "wound"
"""A model has the thread around the body, in turns, spread, or as a fixed circumference."""
ARC = "arc"
"""A model bends uniformly all along, so that it can be kept straight all along."""
HELD = "held"
"""A model has the centre-line of a uniform bend, whose stretch and turns can be held."""
SPACE = "space"
"""A model is a whole body in space, with everything that can act on one."""
LINE = "line"
"""A model is a line in space with two ends, on which weights, tip loads and obstacles act."""
ENDS = "ends"
"""A model gives the force of a support of the tip."""
STRIPS = "strips"
"""Roof and post are surfaces of the model, sheath and cap under them yield."""
VOLUME = "volume"
"""A model can be driven by the volume of its chamber."""
TWIST = "twist"
"""A model can twist."""
SIDE = "side"
"""A model can bend to the side."""
THREAD = "thread"
"""A winding has its pitch and its thread stretches."""
TURNS = "turns"
"""Every turn of a winding lies where it is wound."""
OUTLINE = "outline"
"""A model has a winding as the outline of its section alone, alike all along."""
HOOPS = "hoops"
"""A circumference can be fixed."""
ZONES = "zones"
"""Winding and materials may differ along the length."""
MOTION = "motion"
"""A model moves in time, with its mass."""


@dataclasses.dataclass(frozen=True)
class Inflation:
    """How the chamber is loaded: one of the three is given.

    Attributes:
        to: pressure at the end, MPa.
        volume: chamber volume at the end, mm³.
        angle: bending angle at the end, rad.
    """

    to: float | None = None
    volume: float | None = None
    angle: float | None = None


@dataclasses.dataclass(frozen=True)
class Draft:
    """What is valid of a case that is being checked.

    Attributes:
        actuator: its dimensions, where they go together, else None.
        length: of the chamber, mm, where it is valid, else None.
        effects: by their paths.
        moves: it has a time, and what is in it mass.
    """

    actuator: Actuator | None
    length: float | None
    effects: Mapping[str, Effect]
    moves: bool = False


@dataclasses.dataclass(frozen=True)
class Site:
    """The actuator of a case as its effects see it.

    Attributes:
        actuator: dimensions.
        materials: of each of its parts.
        straight: an effect keeps the actuator from bending.
        mirrored: no effect breaks its mirror plane x = 0.
        weight: acceleration by which it is heavy, x, y and z, mm/s²; None: without weight.
        origin: z on the actuator where the mesh of a slice that repeats begins, mm.
    """

    actuator: Actuator
    materials: Mapping[str, Material]
    straight: bool
    mirrored: bool = True
    weight: tuple[float, float, float] | None = None
    origin: float = 0.0


@dataclasses.dataclass(frozen=True)
class Requests:
    """What a case asks of the path of a load.

    Attributes:
        first: first step, MPa, or None.
        largest: greatest step, MPa, or None.
        at_pressures: pressures to be hit, MPa.
        at_angles: bending angles to be hit under any load, rad.
        stop_at_angle: where the run ends early, rad, or None.
    """

    first: float | None
    largest: float | None
    at_pressures: tuple[float, ...]
    at_angles: tuple[float, ...]
    stop_at_angle: float | None


@dataclasses.dataclass(frozen=True)
class Stretch:
    """A zone along the length as an effect of its own is built there.

    Attributes:
        effect: of the zone.
        site: the actuator, as long as the zone, with the materials there.
        mesh: of the whole body, its winding that of the zone alone, z = 0 at the zone's root end.
        start: z of that end in the body, mm.
    """

    effect: Effect
    site: Site
    mesh: MeshData
    start: float


@dataclasses.dataclass(frozen=True)
class Built:
    """An effect as the finite-element code takes it.

    Attributes:
        terms: summands of the potential, constraints.
        ramps: loads of the whole actuator, in order.
        fibers: thread on the mesh, if the effect has any.
        smeared: that thread is spread over its surface.
    """

    terms: tuple[Term, ...]
    ramps: tuple[Ramp, ...] = ()
    fibers: EmbeddedFibers | None = None
    smeared: bool = False


@dataclasses.dataclass(frozen=True)
class RodSite:
    """The actuator of a case as a rod, as its effects see it.

    Attributes:
        actuator: dimensions; its sections stand across the line, of which `layout` has the height.
        layout: pieces, free strains and clamped root: z from −cap on, y at the line of centroids.
        inertia: of the sections on the frames, (n + 1, 4, 4); see `rod.inertia`.
        tip: the outer face's centroid in the axes of the last frame, mm.
        weight: acceleration by which it is heavy, x, y and z, mm/s²; None: without weight.
        body: the actuator as effects of a body see it, with its materials; None: not known.
    """

    actuator: ShapedActuator
    layout: Layout
    inertia: Floats
    tip: tuple[float, float, float]
    weight: tuple[float, float, float] | None = None
    body: Site | None = None


@dataclasses.dataclass(frozen=True)
class RodRamp:
    """One load of a rod: the amount of some of its terms, or the pressure of its chamber.

    Attributes:
        load: its name, by which columns call it.
        target: the amount at the end; of the pressure what it is driven by.
        drive: as of `fem.march.records.Ramp`: 'value', 'conjugate' or 'control'.
        units: of the amount and of what it does work on, which end the names of the columns.
        potential: it has one, so that its columns tell its work.
    """

    load: str
    target: float = 1.0
    drive: str = "value"
    units: tuple[str, str] = ("", "mJ")
    potential: bool = True


@dataclasses.dataclass(frozen=True)
class OnRod:
    """An effect as a rod takes it.

    Attributes:
        terms: of the rod, each with the load that is its amount; without a name it acts whole from
            the beginning.
        ramps: loads, in order.
        inertia: masses that it adds to the frames, (n + 1, 4, 4); None: none.
        obstacles: those of the terms that are contacts, by the obstacle's name.
    """

    terms: tuple[tuple[str, RodTerm], ...] = ()
    ramps: tuple[RodRamp, ...] = ()
    inertia: Floats | None = None
    obstacles: tuple[tuple[str, Touch], ...] = ()


def mirror_breakers(effects: Iterable[Effect]) -> Iterator[str]:
    """Why x = 0 is no mirror plane, one reason for each effect that breaks the symmetry."""
    for effect in effects:
        reason = effect.mirror_breaker()
        if reason:
            yield reason


def tip_strips(effects: Iterable[Effect]) -> Strips | None:
    """The strips of roof and post, of the first effect that has any."""
    found = (effect.strips() for effect in effects)
    return next((strips for strips in found if strips is not None), None)
