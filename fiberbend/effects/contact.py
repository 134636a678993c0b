"""Rigid obstacles without friction that the outer surface may touch and leave."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fiberbend import columns as col
from fiberbend.effects.blocked_tip import OF_STRIPS, tip_force_summary
from fiberbend.effects.clearance import from_bar, over_plane
from fiberbend.effects.effect import SPACE, Built, Draft, Effect, Requests, Site
from fiberbend.effects.obstacles import CylinderSpec, ObstacleSpec, PlaneSpec, PostSpec, RoofSpec
from fiberbend.effects.records import LINE, OnRod, RodSite
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import PenaltyStiffness
from fiberbend.schema.units import show

if TYPE_CHECKING:
    from fem.effects.contact import Obstacle
    from fem.march.records import Rules
    from fem.solver.newton import Settings
    from fiberbend.states.obstacles import Shape
    from geometry.actuator import Actuator
    from geometry.mesh.data import MeshData
    from geometry.sections.size import MeshSize, Strips

STIFFNESS = 100.0
"""Obstacles are so many times as stiff as what touches them."""
ITERATIONS = 25
SHARPER = 0.01
"""Factor on the tolerance of forces."""
BLOCKED_TURN = 0.05
"""Turn in the first step of a body between roof and post, rad."""
BLOCKED_GROWTH = 3.0
_REACH = 0.5
"""Part of the length by which the tip's lever grows while the body bends."""
_ROUNDING = 1e-9
"""Part of the height by which round-off may put an obstacle into the actuator."""
_FELT = 0.5
"""Least radius of a bar, in lengths of an element: it is felt at three points an element, and a
thinner one goes between them."""
_SUNK = 0.05
"""Depth in an obstacle, as a part of the thickness of what touches it, that is worth a warning; by
default it stays under 0.015 (docs/contact.md)."""


def placed_obstacles(effects: Iterable[Effect], actuator: Actuator) -> dict[str, Obstacle]:
    """The rigid bodies of a case by their names, in space, beside an actuator at rest."""
    return {
        name: item.placed(actuator)
        for effect in effects
        if isinstance(effect, ContactEffect)
        for name, item in effect.obstacles.items()
    }


class ContactEffect(Effect):
    """Rigid obstacles without friction that the outer surface may touch and leave."""

    name = "contact"

    roof: RoofSpec | None = None
    """A straight roof over the chamber; with a post, the paper's test of the tip force."""
    post: PostSpec | None = None
    """A post under the tip."""
    plane: PlaneSpec | None = None
    """A plane anywhere."""
    cylinder: CylinderSpec | None = None
    """A round bar to be grasped."""
    stiffness: PenaltyStiffness | None = None
    """Pressure per depth with which the obstacles yield; by default a hundred times the modulus
    over the thickness of what touches, between roof and post with the wall's modulus."""

    @property
    def obstacles(self) -> dict[str, ObstacleSpec]:
        """Those that the case names."""
        all_of_them: dict[str, ObstacleSpec | None] = {
            "roof": self.roof,
            "post": self.post,
            "plane": self.plane,
            "cylinder": self.cylinder,
        }
        return {name: item for name, item in all_of_them.items() if item is not None}

    def needs(self) -> dict[str, str]:
        """A line in space."""
        return {LINE: "obstacles need a line in space (effect straight: the blocked uniform bend)"}

    def wants(self) -> dict[str, str]:
        """Sections that yield where they touch."""
        text = "sections keep their outline at rest: the baseline is within 2 % of a body"
        if self.strips() is not None:
            text = f"under roof and post the sheath alone yields, {OF_STRIPS}"
        return {SPACE: f"{text} (docs/contact.md)"}

    def mirror_breaker(self) -> str:
        """A plane whose normal has an x component."""
        tilted = self.plane is not None and self.plane.normal[0] != 0
        return "a plane that is tilted sideways pushes to one side" if tilted else ""

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """A second roof or post, nothing to touch, no room."""
        for other, effect in draft.effects.items():
            if effect is self or effect.strips() is None:
                continue
            for name in ("roof", "post"):
                if getattr(self, name) is not None:
                    text = f"{other} has it already, expected one of them"
                    yield Problem(f"{path}.{name}", text)
        if not self.obstacles:
            yield Problem(path, "nothing to touch, expected roof, post, plane or cylinder")
        plane, bar = self.plane, self.cylinder
        if plane is not None and not any(plane.normal):
            yield Problem(f"{path}.plane.normal", "[0, 0, 0], expected a direction")
            plane = None
        actuator = draft.actuator
        if actuator is None:
            return
        rooms = {
            "plane": None if plane is None else over_plane(actuator, plane),
            "cylinder": None if bar is None else from_bar(actuator, bar),
        }
        for name, room in rooms.items():
            if room is not None and room < -_ROUNDING:
                yield Problem(
                    f"{path}.{name}",
                    f"reaches {show(-room, 'length')} into the actuator at rest, "
                    "expected room for it",
                )

    def unresolved(self, size: MeshSize) -> Iterator[tuple[str, str]]:
        """A bar thinner than an element."""
        length = size.axial / (size.section if size.element == "tetrahedron" else 1)
        bar, least = self.cylinder, _FELT * length
        if bar is not None and bar.radius < least * (1 - _ROUNDING):
            yield (
                "cylinder.radius",
                f'"{show(bar.radius, "length")}", expected at least "{show(least, "length")}", '
                f"half an element: elements {show(length, 'length')} long do not feel a thinner "
                "bar (mesh.axial)",
            )

    def keeps_straight(self) -> bool:
        """Between roof and post."""
        return self.roof is not None and self.post is not None

    def strips(self) -> Strips | None:
        """Those of roof and post, of both where there is one."""
        from geometry.sections.size import Strips

        if self.roof is None and self.post is None:
            return None
        roof, post = self.roof or RoofSpec(), self.post or PostSpec()
        return Strips(roof_half_width=roof.width / 2, post_length=post.length)

    def obstacle_shapes(self, actuator: Actuator) -> dict[str, Shape]:
        """All that the case names."""
        return {name: item.shape(actuator) for name, item in self.obstacles.items()}

    def obstacle_forces(self, row: Mapping[str, Any]) -> dict[str, tuple[float, float, float]]:
        """Those along y and z, which the history has."""
        forces = {}
        for name in self.obstacles:
            up, along = (row.get(col.contact(name, f"{axis}_N")) for axis in "yz")
            if up is not None and along is not None:
                forces[name] = (0.0, float(up), float(along))
        return forces

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """The obstacles' softness."""
        if straight:
            yield "obstacles: yield a little, which costs 0.2 % of the force (docs/contact.md)"
        else:
            yield "obstacles: yield a little: up to 0.3 % of their force (docs/contact.md)"

    def alone(self) -> str:
        """The section beside a body between roof and post is kept straight."""
        return "" if self.keeps_straight() else "obstacles act"

    def steps(self) -> int:
        """It is no load."""
        return 0

    def touches(self) -> bool:
        """That is what it is for."""
        return True

    def largest_turn(self, length: float, cap: float) -> float:
        """No step passes through a bar: the tip moves less than its radius."""
        if self.cylinder is None:
            return math.inf
        return self.cylinder.radius / (_REACH * length + cap)

    def settings(self, usual: Settings) -> Settings:
        """More iterations for the active set, and a sharper tolerance.

        Contact forces are small against those in the fibers, which scale the tolerance.
        """
        return dataclasses.replace(
            usual, iterations=ITERATIONS, tolerance=SHARPER * usual.tolerance
        )

    def rules(self, usual: Rules, straight: bool) -> Rules:
        """Increment control along obstacles.

        The active set takes some six iterations however short the step is: they do not shorten it.
        A body that is kept straight hardly turns at first, and its steps may grow fast. Contact
        kinks every curve: extrapolation from two states is better than from three, and a jump
        of the volume is no sign of another branch.
        """
        first, grow = (BLOCKED_TURN, BLOCKED_GROWTH) if straight else (usual.turn, usual.grow)
        return dataclasses.replace(
            usual,
            easy=10,
            slow=16,
            grow=grow,
            memory=2,
            first_turn=min(usual.first_turn, first),
            jump=math.inf,
        )

    def yields(self, site: Site) -> float:
        """Pressure per depth with which the obstacles yield, MPa/mm.

        What touches them, a layer of thickness h and Young's modulus E, yields by h/E times the
        pressure; the obstacle by a hundredth of that. Between roof and post, where nothing else
        yields, E is the wall's, also under a softer sheath.
        """
        if self.stiffness is not None:
            return self.stiffness
        sheath, material = site.actuator.sheath, site.materials["wall"]
        if sheath is not None and not site.straight:
            material = site.materials.get("sheath", material)
        return STIFFNESS * 3 * material.initial_shear_modulus / _touching_layer(site)

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """One penalty for each obstacle."""
        from fem.effects.contact import Contact

        stiffness = self.yields(site)
        return Built(
            tuple(
                Contact(name, item.placed(site.actuator), item.surfaces, stiffness)
                for name, item in self.obstacles.items()
            )
        )

    def on_rod(self, site: RodSite) -> OnRod:
        """One penalty for each obstacle; under roof and post the sheath yields too."""
        from fiberbend.outline.sheath import under_strip
        from fiberbend.outline.skins import skin
        from rod.contact.touch import Touch

        assert site.body is not None, "an obstacle is as stiff as what touches it"
        met = []
        for name, item in self.obstacles.items():
            stiffness, part, strip = self.yields(site.body), 1.0, item.strip()
            if strip is not None:
                stiffness, part = under_strip(site.body, *strip, stiffness)
            points = skin(site, item.surfaces, self.strips())
            met.append((name, Touch(points, item.met(site.actuator), stiffness, part=part)))
        return OnRod(tuple(("", touch) for _, touch in met), obstacles=tuple(met))

    def doubts(self, site: Site, rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
        """Obstacles so soft that the body sinks into them."""
        thickness = _touching_layer(site)
        for name in self.obstacles:
            depth = self._depth(name, rows)
            if depth > _SUNK * thickness:
                yield (
                    f"contact: the body sinks {depth:.3g} mm into the {name}, "
                    f"{100 * depth / thickness:.0f} % of the {thickness:g} mm that touch it, as "
                    f"obstacles yield with {self.yields(site):.3g} MPa/mm: too soft to be rigid "
                    "(contact.stiffness, by default a hundred times that of what touches)"
                )

    @staticmethod
    def _depth(name: str, rows: Sequence[Mapping[str, Any]]) -> float:
        """Greatest depth in an obstacle over a history, mm."""
        return max(0.0, *(-row.get(col.contact(name, "gap_mm"), 0.0) for row in rows))

    def summary(self, site: Site, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
        """When each obstacle was touched and left, and the force on the body at the end."""
        strips = self.strips()
        tip = {}
        if self.keeps_straight() and strips is not None:
            tip = tip_force_summary(site, strips, rows[-1])
        entry: dict[str, Any] = {"stiffness_MPa_per_mm": self.yields(site)}
        for name in self.obstacles:
            touching = [bool(row.get(col.contact(name, "area_mm2"))) for row in rows]
            changes = [i for i in range(1, len(rows)) if touching[i] != touching[i - 1]]
            entry[name] = {
                "touched_at_kPa": [rows[i][col.PRESSURE] for i in changes if touching[i]],
                "left_at_kPa": [rows[i][col.PRESSURE] for i in changes if not touching[i]],
                "force_y_N": rows[-1].get(col.contact(name, "y_N")),
                "force_z_N": rows[-1].get(col.contact(name, "z_N")),
                "greatest_depth_mm": self._depth(name, rows),
            }
        return {**tip, "contact": entry}


def _touching_layer(site: Site) -> float:
    """Thickness of what touches an obstacle, mm: the sheath, or the wall where there is none."""
    sheath = site.actuator.sheath
    return site.actuator.wall if sheath is None else sheath
