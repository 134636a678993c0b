"""Pressure in the chamber: by its value, the chamber's volume or the bending angle."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fiberbend.effects.effect import (
    CHAMBER,
    VOLUME,
    Built,
    Draft,
    Effect,
    Inflation,
    Requests,
    Site,
)
from fiberbend.effects.records import OnRod, RodRamp, RodSite
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import Angle, SignedPressure, Volume

if TYPE_CHECKING:
    from geometry.mesh.data import MeshData


class PressureEffect(Effect):
    """Pressure in the closed chamber: by its value, the chamber's volume or the bending angle."""

    name = "pressure"
    load = True

    to: SignedPressure | None = None
    """Chamber pressure at the end; negative is a vacuum."""
    volume: Volume | None = None
    """Chamber volume at the end; the pressure is found."""
    angle: Angle | None = None
    """Bending angle at the end; the pressure is found. Never meets a pressure limit."""

    def needs(self) -> dict[str, str]:
        """A chamber, and its volume where that is given."""
        needed = {CHAMBER: "it has no chamber to inflate"}
        if self.volume is not None:
            needed[VOLUME] = "the closed form bends by pressure or angle, not by volume"
        return needed

    def mirror_breaker(self) -> str:
        """None: it acts on both sides alike."""
        return ""

    def end_breaker(self) -> str:
        """None: it acts alike all along."""
        return ""

    def turn_breaker(self) -> str:
        """None: it acts alike all along."""
        return ""

    def bends(self) -> bool:
        """It acts above as below."""
        return False

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """One of the three is given."""
        given = [key for key in ("to", "volume", "angle") if getattr(self, key) is not None]
        if not given:
            yield Problem(path, 'nothing to reach, expected to, such as "200 kPa", volume or angle')
        for key in given[1:]:
            yield Problem(f"{path}.{key}", f"{given[0]} is given too, expected one of them")

    def inflation(self) -> Inflation:
        """As the case gives it."""
        return Inflation(self.to, self.volume, self.angle)

    def follows_section(self) -> bool:
        """The section is solved under it."""
        return True

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """None: the model's own errors were measured with it."""
        yield from ()

    def alone(self) -> str:
        """The section is solved under it."""
        return ""

    def steps(self) -> int:
        """None beside those of the chamber's load."""
        return 0

    def _driven(self) -> tuple[str, float]:
        """What is given, as a ramp drives it, and its value at the end."""
        for drive, target in (("conjugate", self.volume), ("control", self.angle)):
            if target is not None:
                return drive, target
        assert self.to is not None, "checked when the case was read"
        return "value", self.to

    def on_rod(self, site: RodSite) -> OnRod:
        """It is in the law of the section: a load without a term."""
        drive, target = self._driven()
        return OnRod(ramps=(RodRamp("pressure", target, drive),))

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """−P V, with the path of the load."""
        from fem.effects.chamber_pressure import ChamberPressure
        from fem.march.records import Ramp

        drive, target = self._driven()
        by_value = drive == "value"
        ramp = Ramp(
            ChamberPressure.scalar,
            target=target,
            drive=drive,
            first=requests.first if by_value else None,
            largest=requests.largest if by_value else None,
            stops=requests.at_pressures if by_value else (),
        )
        return Built((ChamberPressure(),), (ramp,))


def inflate(
    *, to: float | None = None, angle: float | None = None, volume: float | None = None
) -> PressureEffect:
    """A pressure by its value in MPa, the bending angle in rad or the chamber's volume in mm³."""
    return PressureEffect.model_construct(to=to, angle=angle, volume=volume)
