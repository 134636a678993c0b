"""Values that no soft robot has: most often a slip of the unit, which is asked back.

Every bound lies far beyond what is built. Actuators of micrometres and of metres are legal, as are
rubbers a million times as soft or as stiff as silicone: what counts there are proportions, which
are checked with the case.
"""

from __future__ import annotations

import dataclasses
import math

from fiberbend.schema.units import KINDS, show

_THOUSANDS = (1e-3, 1e3, 1e-6, 1e6, 1e-9, 1e9)
_ROUNDING = 1 + 1e-9


@dataclasses.dataclass(frozen=True)
class Limits:
    """Magnitudes of a kind of quantity, in its internal unit.

    Attributes:
        least: the smallest that is taken; of values that may have either sign none is too small.
        most: the greatest that is taken.
        words: both, as a message has them.
        usual: the range in which a slip is looked for.
        slips: what a value is multiplied with to find what was meant, the likeliest first.
    """

    least: float
    most: float
    words: tuple[str, str]
    usual: tuple[float, float]
    slips: tuple[float, ...] = _THOUSANDS

    def refusal(self, value: float, kind: str, small: bool) -> str | None:
        """Why a value is asked back, as 'expected …; did you mean …?', or None.

        Args:
            value: in the internal unit; zero is not asked back.
            kind: a key of `fiberbend.schema.units.KINDS`.
            small: values can be too small, not too great only.
        """
        size = abs(value)
        low = self.least / _ROUNDING if small else 0.0
        if size == 0 or low <= size <= self.most * _ROUNDING:
            return None
        least, most = self.words
        wanted = f"from {least} to {most}" if small else f"up to {most}"
        return f"expected {KINDS[kind].name} {wanted}{self.meant(value, kind)}"

    def meant(self, value: float, kind: str, most: float = math.inf) -> str:
        """The end of a message with what a slip would have been; empty where nothing fits.

        Args:
            value: in the internal unit.
            kind: a key of `fiberbend.schema.units.KINDS`.
            most: the greatest magnitude that fits, in the internal unit.
        """
        low, high = self.usual
        for factor in self.slips:
            guess = float(f"{value * factor:.12g}")
            if low / _ROUNDING <= abs(guess) <= min(high, most) * _ROUNDING:
                number, unit = show(guess, kind).split(" ", 1)
                return f'; did you mean "{float(number):.6g} {unit}"?'
        return ""


LIMITS = {
    # down to a nanometre, for threads and elements of a body of some micrometres
    "length": Limits(1e-6, 1e6, ("1 nm", "1 km"), (1e-2, 1e3)),
    "pressure": Limits(1e-16, 1e6, ("0.1 nPa", "1 TPa"), (1e-3, 10.0)),
    "modulus": Limits(1e-9, 1e11, ("1 mPa", "100 PPa"), (1e-3, 5e5)),
    # from twice the density of air to more than that of osmium
    "density": Limits(2.5e-12, 3e-8, ("2.5 kg/m^3", "30 g/cm^3"), (1e-10, 1e-8)),
    "acceleration": Limits(1e-3, 5e6, ("1 um/s^2", "5000 m/s^2"), (1e2, 1e5)),
    "volume": Limits(1e-18, 1e18, ("1 nm^3", "1 km^3"), (1.0, 1e7)),
    "force": Limits(1e-15, 1e9, ("1 fN", "1 GN"), (1e-4, 1e3)),
    "moment": Limits(1e-18, 1e12, ("1e-18 N*mm", "1 GN*m"), (1e-3, 1e5)),
    "mass": Limits(1e-18, 1e3, ("1 pg", "1000 t"), (1e-8, 1e-2)),
    # below, thread and rubber themselves are no better known; above, it asks for nothing
    "accuracy": Limits(0.1, 20.0, ("0.1 %", "20 %"), (0.5, 20.0), (100.0,)),
    # thirty turns: 360 rad were degrees
    "angle": Limits(1e-9, 200.0, ("1 nrad", "200 rad"), (1e-2, 50.0), (math.pi / 180,)),
}
"""Those of any quantity of a kind; a dimension of a body has narrower ones."""

DIMENSION = Limits(1e-3, 1e5, ("1 um", "100 m"), LIMITS["length"].usual)
"""Of a dimension across a body."""
LENGTH = Limits(1e-3, 1e6, ("1 um", "1 km"), LIMITS["length"].usual)
"""Of its length, which is many times the greatest of those."""
