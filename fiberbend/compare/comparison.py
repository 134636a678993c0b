"""A run beside one other model, or beside measured points, in numbers and words."""

from __future__ import annotations

import dataclasses
from typing import Any

from fiberbend.compare.causes import Cause


@dataclasses.dataclass(frozen=True)
class Comparison:
    """A run beside one other model, or beside measured points.

    Attributes:
        name: as run.json calls the other one.
        label: as a message calls it.
        percent: the greatest difference, signed, in per cent of the other one.
        at: where, such as "180.0°".
        band: percent within which they are expected to agree; None where that is not known.
        causes: estimates of what sets them apart there.
        limits: of what a difference beyond the band is known, where a cause is found; may be empty.
        quantity: what is compared, "pressure" or "force".
        reference: the run is measured by the other one, not the other one by the run.
    """

    name: str
    label: str
    percent: float
    at: str
    band: float | None
    causes: tuple[Cause, ...] = ()
    limits: str = ""
    quantity: str = "pressure"
    reference: bool = False

    @property
    def beyond(self) -> bool:
        """Whether the greatest difference is beyond the band."""
        return self.band is not None and abs(self.percent) > self.band

    @property
    def unexpected(self) -> bool:
        """Whether it casts doubt on the run."""
        return self.beyond and not (self.limits and self.likely)

    @property
    def likely(self) -> list[Cause]:
        """The causes that account for a good part of the difference."""
        return [cause for cause in self.causes if cause.explains(self.percent)]

    def entry(self) -> dict[str, Any]:
        """Its entry of run.json."""
        entry: dict[str, Any] = {
            "greatest_percent": round(self.percent, 3),
            "at": self.at,
            "band_percent": self.band,
            "beyond_band": self.beyond,
            "text": self.line(),
        }
        if self.causes:
            entry["estimates_percent"] = {c.name: _rounded(c.percent) for c in self.causes}
        if self.beyond:
            entry["likely"] = [f"{c.name}: {c.text}" for c in self.likely] or ["unexplained"]
        return entry

    def line(self) -> str:
        """Its line for the user: by how much the other one is higher or lower than the run."""
        return f"{self._difference()} at {self.at}{self._verdict()}"

    def _difference(self) -> str:
        ratio = 1 + self.percent / 100
        if ratio <= 0:
            return f"{self.label}: {self.quantity} of the other sign"
        percent = self.percent if self.reference else 100 * (1 / ratio - 1)
        size = f"{abs(percent):.1f} % {'higher' if percent > 0 else 'lower'}"
        if self.reference:
            return f"run: {self.quantity} {size} than {self.label}"
        return f"{self.label}: {self.quantity} {size}"

    def _verdict(self) -> str:
        """Whether that is expected, and why."""
        if self.band is None:
            return ""
        causes = self.likely
        if not self.beyond:
            why = " and ".join(cause.brief or cause.name for cause in causes)
            return f", as expected {f'for {why}' if why else f'(within {self.band:g} %)'}"
        names = ", ".join(cause.name for cause in causes)
        if self.limits and names:
            return f", by known limits of {self.limits}: {names}"
        reason = f"likely {names}" if names else "unexplained"
        return f", beyond the {self.band:g} % expected: {reason}"


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 3)
