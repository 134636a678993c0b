"""Supports: displacement components fixed on named surfaces."""

from __future__ import annotations

from collections.abc import Hashable

from fem.effects.effect import Constraint, Effect


class Clamp(Effect):
    """All displacement components fixed on a surface.

    Args:
        surface: named surface, by default the root cap's outer face.
    """

    def __init__(self, surface: str = "clamp") -> None:
        self.surface = surface

    @property
    def key(self) -> str:
        """Several clamps may exist, one a surface."""
        return f"Clamp[{self.surface}]"

    def constraints(self) -> tuple[Constraint, ...]:
        """u = 0."""
        return tuple(Constraint("clamp", self.surface, i) for i in range(3))


class Symmetry(Effect):
    """A mirror plane: the displacement across it is fixed at zero.

    Args:
        surface: named surface in the plane.
        component: axis normal to the plane.
        halves: it cuts a body in half that is held otherwise too: modes of the opposite symmetry
            are no rigid motions and are counted.
    """

    def __init__(self, surface: str = "symmetry", component: int = 0, halves: bool = False) -> None:
        self.surface, self.halves = surface, halves
        self.component = component

    @property
    def key(self) -> str:
        """Several mirror planes may exist, one a surface."""
        return f"Symmetry[{self.surface}]"

    def structure(self) -> Hashable:
        """All that it fixes."""
        return self.constraints(), self.opposite()

    def constraints(self) -> tuple[Constraint, ...]:
        """No displacement across the plane."""
        return (Constraint("symmetry", self.surface, self.component),)

    def opposite(self) -> tuple[Constraint, ...] | None:
        """Displacements in the plane are fixed instead."""
        if not self.halves:
            return None
        others = (i for i in range(3) if i != self.component)
        return tuple(Constraint("symmetry", self.surface, i) for i in others)


class TwofoldAxis(Effect):
    """Half a turn about the y axis maps the body onto itself: u = w = 0 on the plane x = 0.

    A section with a smeared single helix has this symmetry instead of a mirror plane: (u, v, w) at
    (−x, y) are (−u, v, −w) at (x, y).

    Args:
        surface: named surface in the plane.
    """

    def __init__(self, surface: str = "symmetry") -> None:
        self.surface = surface

    def structure(self) -> Hashable:
        """All that it fixes."""
        return self.constraints(), self.opposite()

    def constraints(self) -> tuple[Constraint, ...]:
        """No displacement across the plane, and none along z in it."""
        return tuple(Constraint("symmetry", self.surface, i) for i in (0, 2))

    def opposite(self) -> tuple[Constraint, ...] | None:
        """The displacement along y, about which half a turn is made, is fixed instead."""
        return (Constraint("symmetry", self.surface, 1),)


class StraightAxis(Effect):
    """Uniform bending with both curvatures fixed at zero, and the stretch at one if wanted.

    Args:
        stretch: fix the stretch too.
    """

    def __init__(self, stretch: bool = False) -> None:
        self.stretch = stretch

    def structure(self) -> Hashable:
        """It holds scalars, and no more."""
        return ()

    def fixed_scalars(self) -> dict[str, float]:
        """k_x = k_y = 0, and λ0 = 1."""
        return {"curvature": 0.0, "side_curvature": 0.0} | (
            {"stretch": 1.0} if self.stretch else {}
        )


class BlockedTip(Effect):
    """A straight roof over the body and a post under the tip (paper III-C, V-C, Fig. 11a).

    Guided form: the vertical displacement v is fixed on a strip along the crown and on a strip at
    the distal end of the tip cap's underside; u and w stay free.

    Args:
        roof: named surface of the strip under the roof.
        post: named surface of the strip over the post.
    """

    def __init__(self, roof: str = "roof", post: str = "post") -> None:
        self.roof = roof
        self.post = post

    def constraints(self) -> tuple[Constraint, ...]:
        """v = 0 on both strips."""
        return (Constraint("roof", self.roof, 1), Constraint("post", self.post, 1))
