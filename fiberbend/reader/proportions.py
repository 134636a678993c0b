"""Loads out of all proportion to the body: most often a slip of the unit, which is asked back."""

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
_COLLAPSED = 0.01
"""Least volume over the chamber's at rest."""


def disproportions(draft: Draft, materials: Materials | None) -> Iterator[Problem]:
    """Pressures beyond any rubber, and volumes beyond any chamber.

    Args:
        draft: what is valid of a case.
        materials: those of the case where they are valid.
    """
    for path, effect in draft.effects.items():
        load = effect.inflation()
        if load is None:
            continue
        if load.to is not None and materials is not None:
            yield from _pressure(f"{path}.to", load.to, materials)
        if load.volume is not None and draft.actuator is not None:
            yield from _volume(f"{path}.volume", load.volume, draft.actuator)


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
