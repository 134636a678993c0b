"""Rubber that bulges between the fibers, which no smeared winding sees: measured, and scaled.

docs/crosscheck.md has the numbers behind the rules.
"""

from __future__ import annotations

from collections.abc import Iterator

from fiberbend.case.case import Case
from fiberbend.case.zones import zone_cases
from fiberbend.models.choice import choose_model
from fiberbend.models.model import ModelKind

BULGING_PITCH = 3.0
"""Pitch in mm for which the bulging between the fibers was measured."""
FARTHEST_PITCH = 6.0
"""Twice that: beyond, nothing is known of it."""
CALIBRATED = 0.3
"""Percent of pressure for an angle by which a calibrated section is off a fine cell: pitch 1.5 to
4.5 mm, radius 6 to 12 mm, wall 1 to 3 mm (docs/evidence/calibration.md)."""
_WIDE, _CALIBRATED_WIDE = 4.5, 0.7
"""Pitch in mm beyond which cells of fine meshes differ, and the percent up to the farthest."""
_BULGING = ((90.0, 3.5), (180.0, 4.1), (270.0, 4.7), (360.0, 5.1))
"""Angle in degrees, and percent of pressure that every fiber by itself takes beyond a smeared
winding: the cell against the section model, baseline."""
_BULGING_EXPONENT = 1.3


def bulging(pitch: float, angle_deg: float) -> float:
    """Percent of pressure that rubber bulging between the fibers takes, scaled by the pitch.

    Args:
        pitch: pitch of the double helix, mm.
        angle_deg: bending angle, degrees.
    """
    import numpy as np

    angles, percent = zip(*_BULGING, strict=True)
    scale = (pitch / BULGING_PITCH) ** _BULGING_EXPONENT
    return scale * float(np.interp(abs(angle_deg), angles, percent))


def beyond_section(case: Case, model: ModelKind) -> float:
    """Part of the bulging that a model gives and the section solved beside it does not."""
    turns = case.turns
    return 0.0 if turns is not None and turns.bulges else model.resolved_bulging(case)


def _within(pitch: float) -> str:
    """How near a calibrated winding is to a fine cell, in words."""
    if pitch > FARTHEST_PITCH * (1 + 1e-9):
        return f"how near to the cell's P is not known beyond {FARTHEST_PITCH:g} mm"
    percent = CALIBRATED if pitch <= _WIDE * (1 + 1e-9) else _CALIBRATED_WIDE
    return f"P within {percent} % of a fine cell's"


def lost_pressure(case: Case, model: ModelKind) -> Iterator[str]:
    """What a model does not see of the rubber between the turns, in words."""
    turns = case.turns
    if turns is None or case.inflation is None or case.straight or model.line:
        return
    if turns.pitch is None:
        if turns.bulges:
            yield (
                "winding: with the bulges of its own cell, most families within 1.5 % of its turns "
                "and lengthening; the run says what is left (docs/evidence/families.md)"
            )
        elif model.resolved_bulging(case) < 1:
            yield (
                "winding: the rubber between its threads bulges, which is left out: beside cells "
                "up to 3 % of the twist of one family, 6 to 9 % of the lengthening of a braid, 4 "
                "to 15 % of a bend, 20 % of the twist of two families that all but balance, nine "
                "tenths of all motion where three lock each other (docs/evidence/families.md; as: "
                "calibrated, or discrete with elements of half their spacing along the axis)"
            )
        return
    if turns.bulges:
        # numbers that a case gives may be those of another section
        yield (
            f"winding: with the bulges of its own cell {_within(turns.pitch)} "
            "(docs/evidence/calibration.md)"
        )
        return
    missing = 1 - model.resolved_bulging(case)
    if missing and turns.pitch > FARTHEST_PITCH:
        yield (
            f"winding: P too low, as the rubber between turns {turns.pitch:g} mm apart bulges; by "
            f"how much is not known beyond {FARTHEST_PITCH:g} mm (docs/crosscheck.md)"
        )
        return
    low, high = (missing * bulging(turns.pitch, angle) for angle in (90.0, 360.0))
    if high >= 0.05:
        scaled = "" if turns.pitch == BULGING_PITCH else f", scaled from {BULGING_PITCH:g} mm"
        yield (
            f"winding: P too low by about {low:.1f} % at 90° to {high:.1f} % at 360°: the rubber "
            f"between turns {turns.pitch:g} mm apart bulges (docs/crosscheck.md{scaled})"
        )
    elif model.ends and model.elements():
        yield "winding: resolved; against a cell within 1.5 % (docs/evidence/winding.md)"


def winding_remark(case: Case) -> str | None:
    """Whether the elements of a case's model resolve its winding.

    Returns:
        A sentence, or None without a discrete winding; of zones those that differ.
    """
    if case.zones is not None:
        name = choose_model(case)[0].name
        each = (winding_remark(zone) for zone in zone_cases(case, name))
        return "; ".join(dict.fromkeys(text for text in each if text is not None)) or None
    turns, model = case.turns, choose_model(case)[0].elements()
    if turns is None or not turns.discrete or model is None:
        return None
    axial, most = model.mesh_size(case, model.half(case)[0]).axial, turns.spacing / 2
    apart = f"{turns.spacing:.4g} mm"
    turn = f"turns {apart} apart" if turns.pitch is None else f"a pitch of {apart}"
    if axial <= most * (1 + 1e-9):
        return f"resolved (elements of {axial:.4g} mm, {turn})"
    return (
        f"NOT resolved (elements of {axial:.4g} mm under {turn}, needs "
        f"{most:.4g} mm): rubber between the turns bulges too little, the pressure for "
        "an angle comes out too low"
    )
