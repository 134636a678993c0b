"""What a reader is told below a picture of a run, by the name of its file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from fiberbend.results.states import Kept
from fiberbend.states.labels import short_number

_CAPTIONS = {
    "pressure_angle": "Bending angle against pressure.",
    "over_time": "Pressure, angle, tip and energies over time.",
    "pressure_twist": "Twist against pressure.",
    "tip_force": "Tip force against pressure.",
    "contact_force": "Force of each obstacle on the actuator against pressure.",
    "tip_path": "Path of the tip.",
    "section_shape": "Section of the actuator in several states, with the section at rest.",
    "section_strain": "Greatest principal strain in the section.",
    "section_stress": "Von Mises stress in the section.",
    "cell_bulge": "Rubber between the turns of the fiber.",
    "fiber_stretch": "Axial force and strain of the fiber along its way around the section.",
    "rest": "The actuator at rest, cut open step by step.",
    "undeformed": "The actuator at rest, and a piece cut out of it.",
    "cut": "The last state cut open at x = 0.",
    "montage": "All states that were asked for, at one scale.",
    "bent": "The length between the caps in several states, at one scale.",
    "animation": "All load steps as a film.",
}
_STATE = "bent_"


def caption(name: str, states: Mapping[str, str]) -> str:
    """A sentence below a picture; for a picture of another name, that in words.

    Args:
        name: of its file.
        states: pressure and angle of the states in pictures, by their labels.
    """
    stem = Path(name).stem
    if stem.startswith(_STATE):
        label = stem.removeprefix(_STATE)
        return f"Strain at {states[label]}." if label in states else f"Strain: {label}."
    return _CAPTIONS.get(stem) or stem.replace("_", " ")


def in_short(state: Kept) -> str:
    """Pressure and angle of a state."""
    return f"{short_number(state.pressure_kpa)} kPa, {short_number(state.angle_deg)}°"
