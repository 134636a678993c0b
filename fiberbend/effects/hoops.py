"""Hoops that cannot stretch: the ideal winding of closed forms."""

from __future__ import annotations

from collections.abc import Iterator

from fiberbend.effects.effect import HOOPS, Draft, Effect
from fiberbend.schema.problems import Problem


class HoopsEffect(Effect):
    """Hoops that cannot stretch, without pitch or thread: the ideal winding of closed forms."""

    name = "hoops"

    def needs(self) -> dict[str, str]:
        """A circumference that can be fixed."""
        return {
            HOOPS: "hoops that cannot stretch are in closed forms only (winding: a real thread)"
        }

    def mirror_breaker(self) -> str:
        """None: hoops are symmetric."""
        return ""

    def end_breaker(self) -> str:
        """None: hoops are symmetric."""
        return ""

    def turn_breaker(self) -> str:
        """None: hoops are symmetric."""
        return ""

    def bends(self) -> bool:
        """They hold above as below."""
        return False

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """One winding is enough."""
        for other, effect in draft.effects.items():
            if effect is not self and effect.fixes_circumference():
                text = f"{other} fixes the circumference already, expected one of them"
                yield Problem(path, text)

    def fixes_circumference(self) -> bool:
        """That is all they do."""
        return True

    def not_beside(self) -> str:
        """A section has no constraint for them."""
        return "the section model beside it needs a winding with pitch and fiber"

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """None: the model's own errors were measured with it."""
        yield from ()

    def alone(self) -> str:
        """Closed forms have them too."""
        return ""

    def steps(self) -> int:
        """They are no load."""
        return 0
