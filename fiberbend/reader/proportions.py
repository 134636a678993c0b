"""Loads and shapes out of all proportion: most often a slip of the unit, which is asked back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fiberbend.case import convert
from fiberbend.case.case import Materials
from fiberbend.effects.effect import Draft
from fiberbend.schema.problems import Problem
from fiberbend.schema.slips import LIMITS
from fiberbend.schema.units import show

if TYPE_CHECKING:
    from geometry.actuator import Actuator

PRESSURE = 500.0
"""Greatest pressure over the wall's shear modulus at rest; hydraulic muscles of hard rubber, whose
braid carries all, burst at some 100."""
_LIKELY = 20.0
VOLUME = 1000.0
"""Greatest volume over the chamber's at rest: ten times as long, wide and high."""
WIDE = 50.0
"""Greatest width of a chamber over its length."""
LONG = 5000.0
"""Greatest length of a chamber over its width."""
_COLLAPSED = 0.01
"""Least volume over the chamber's at rest."""


def disproportions(draft: Draft, materials: Materials | None) -> Iterator[Problem]:
    """Pressures beyond any rubber, volumes beyond any chamber, and chambers like a plate or a hair.

    Args:
        draft: what is valid of a case.
        materials: those of the case where they are valid.
    """
    if draft.actuator is not None:
        yield from _shape(draft.actuator)
    for path, effect in draft.effects.items():
        load = effect.inflation()
        if load is None:
            continue
        if load.to is not None and materials is not None:
            yield from _pressure(f"{path}.to", load.to, materials)
        if load.volume is not None and draft.actuator is not None:
            yield from _volume(f"{path}.volume", load.volume, draft.actuator)


def _shape(actuator: Actuator) -> Iterator[Problem]:
    width, length = 2 * actuator.profile.half_width, actuator.length
    if not width / WIDE <= length <= width * LONG:
        yield Problem(
            "actuator",
            f"a chamber {_short(width)} wide and {_short(length)} long, expected from 1/{WIDE:g} "
            f"to {LONG:g} times as long as wide; is a unit wrong?",
        )


def _short(length: float) -> str:
    return f"{length / 1e3:.4g} m" if length >= 1e4 else f"{length:.4g} mm"


def _pressure(path: str, pressure: float, materials: Materials) -> Iterator[Problem]:
    try:
        modulus = convert.material(materials.wall).initial_shear_modulus
    except ValueError:  # reported with the material
        return
    if abs(pressure) > PRESSURE * modulus:
        meant = LIMITS["pressure"].meant(pressure, "pressure", _LIKELY * modulus)
        yield Problem(
            path,
            f'"{show(pressure, "pressure")}", expected at most {PRESSURE:g} times the shear '
            f"modulus of materials.wall, {modulus:.3g} MPa{meant}",
        )


def _volume(path: str, volume: float, actuator: Actuator) -> Iterator[Problem]:
    chamber = actuator.chamber_volume
    if not _COLLAPSED * chamber <= volume <= VOLUME * chamber:
        yield Problem(
            path,
            f'"{show(volume, "volume")}", expected between a hundredth and {VOLUME:g} times the '
            f'chamber at rest, "{float(show(chamber, "volume").split()[0]):.4g} mL"',
        )
