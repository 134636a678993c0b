"""Which symmetries a case leaves to uniform bending, and which unknowns follow from them.

Sections are their own mirror images in x = 0, in shape and materials; along the axis all is alike.
What breaks a symmetry is an effect, and each one answers for itself. ω = (k_x, k_y, τ) turns as an
axial vector a mm of z: the mirror plane z = 0 leaves (k_x, k_y, 0), the mirror plane x = 0 leaves
(k_x, 0, 0), and half a turn about y, which is both, leaves (k_x, 0, τ).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence

from fiberbend.case import convert
from fiberbend.case.case import ActuatorSpec, Case, Materials
from fiberbend.effects.effect import Effect
from materials.laws.table import LAWS


@dataclasses.dataclass(frozen=True)
class Symmetry:
    """What maps a case onto itself; each a tuple of the reasons why it does not.

    Attributes:
        across: the mirror plane x = 0.
        along: the mirror plane z = 0, and with it others along the axis.
        turn: half a turn about y.
    """

    across: tuple[str, ...]
    along: tuple[str, ...]
    turn: tuple[str, ...]

    @classmethod
    def of(cls, effects: Sequence[Effect]) -> Symmetry:
        """Of the effects of a case."""
        return cls(
            _reasons(effect.mirror_breaker() for effect in effects),
            _reasons(effect.end_breaker() for effect in effects),
            _reasons(effect.turn_breaker() for effect in effects),
        )

    @property
    def plane(self) -> bool:
        """Both mirror planes: it bends in its plane, and half of it stands for all."""
        return not self.across and not self.along

    @property
    def twists(self) -> bool:
        """No mirror plane z = 0: the body may twist, and its sections may warp."""
        return bool(self.along)

    @property
    def sideways(self) -> bool:
        """Neither both mirror planes nor half a turn about y: the body may bend to the side.

        The mirror plane x = 0 alone would leave half a section that warps; all is solved then, for
        no case has that symmetry but through effects on which nobody counts.
        """
        return bool(self.turn) and not self.plane

    @property
    def halved(self) -> bool:
        """Half a section stands for all, by a mirror plane or by half a turn about y."""
        return not self.sideways

    def scalars(self) -> tuple[str, ...]:
        """Global unknowns of uniform bending, as `fem.kinematics.uniform` names them."""
        wanted = {"side_curvature": self.sideways, "twist": self.twists}
        return ("curvature", "stretch", *(name for name, free in wanted.items() if free))

    def words(self) -> str:
        """What is left, what follows from it, and what took the rest away."""
        if self.plane:
            return "mirror planes x = 0 and z = 0: it bends in its plane, no side, twist or warping"
        broken = "; ".join(dict.fromkeys((*self.across, *self.along)))
        if not self.turn:
            return (
                "half a turn about y maps it onto itself: it bends about x and twists, its "
                f"section warps, no side ({broken})"
            )
        if not self.along:
            return (
                f"mirror plane z = 0 alone: it bends about x and y, no twist or warping ({broken})"
            )
        return f"none: it bends about x and y and twists, its section warps ({broken})"


def twists(case: Case) -> bool:
    """Whether a case may twist the body."""
    return Symmetry.of(case.acting).twists


def wound(case: Case) -> Symmetry:
    """What the section of a case has by itself, whatever acts on the actuator."""
    beside = (effect.beside() for effect in case.effects)
    return Symmetry.of([effect for effect in beside if effect is not None])


def upside_down(actuator: ActuatorSpec, materials: Materials) -> bool:
    """Whether a section is its own image turned upside down, in shape and materials.

    Args:
        actuator: valid.
        materials: those of its wall and floor are there and valid.
    """
    regions = convert.dimensions(actuator).one_material()
    made = [convert.material(getattr(materials, region)) for region in regions]
    known = [(item.law, LAWS[item.law].complete(item.parameters), item.bulk) for item in made]
    return bool(known) and all(item == known[0] for item in known)


def stays_straight(case: Case) -> bool:
    """Whether nothing bends it: neither its section nor an effect, nor what is said of a zone."""
    if case.zones is not None:
        return False
    alike = upside_down(case.actuator, case.materials)
    return alike and not any(effect.bends() for effect in case.effects)


def _reasons(found: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(reason for reason in found if reason))


def sheared(case: Case) -> bool:
    """Whether forces across a rod may come of it: of all but what its sections have themselves."""
    return any(each.inflation() is None and each.beside() is None for each in case.effects)
