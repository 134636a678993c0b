"""From a hand file to its fingers, all problems at once."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fiberbend.case.case import Case
from fiberbend.case.symmetry import wound
from fiberbend.case.zones import zone_cases
from fiberbend.effects.gravity import GravityEffect
from fiberbend.effects.pressure import PressureEffect
from fiberbend.hand.file import HandFile, HandOutput, name_of, problems
from fiberbend.hand.objects import ObjectSpec
from fiberbend.hand.pose import Pose, Triple
from fiberbend.models.rod import TOUCHED
from fiberbend.reader.base_case import HAND, BaseCase, read_base
from fiberbend.reader.reader import parse_case
from fiberbend.reader.yaml_file import YamlContent, line_numbers, read_yaml
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.units import show
from fiberbend.schema.validation import from_pydantic

_MODEL = "rod"
_NOT_ASKED = ("output", "compare", "accuracy")
"""Parts of a case that say what a run of it alone is to give."""
_IDLE = (*_NOT_ASKED, "mesh", "solver")
"""Parts of a case that say nothing of a finger: to change them for a hand is a mistake."""


@dataclasses.dataclass(frozen=True)
class Finger:
    """An actuator of a hand.

    Attributes:
        name: what it is called.
        case: its checked case, of model rod, at the pressure that it has in the hand.
        pose: where it stands.
    """

    name: str
    case: Case
    pose: Pose

    @property
    def pressure(self) -> float:
        """At the end, MPa."""
        load = self.case.inflation
        assert load is not None, "checked when the hand was read"
        assert load.to is not None, "checked when the hand was read"
        return load.to


@dataclasses.dataclass(frozen=True)
class Hand:
    """A checked hand.

    Attributes:
        title: a line for the reader.
        fingers: in the order of the file.
        objects: what they may touch, by name.
        gravity: acceleration in the axes of the hand, mm/s²; None: nothing weighs anything.
        stiffness: with which all surfaces yield, MPa/mm; None: by what touches.
        output: what is written.
        resolved: the file with the resolved case of every finger.
    """

    title: str
    fingers: tuple[Finger, ...]
    objects: dict[str, ObjectSpec]
    gravity: Triple | None
    stiffness: float | None
    output: HandOutput
    resolved: dict[str, Any] = dataclasses.field(compare=False, repr=False)


def read_hand(path: Path | str, settings: Iterable[str] = ()) -> Hand:
    """Read a hand file, and check the case of every finger.

    Args:
        path: the YAML file.
        settings: changes to the cases of all fingers, `actuator.floor=3 mm`, after those of the
            file.

    Raises:
        CaseError: everything that is wrong with it.
    """
    path = Path(path)
    source = read_yaml(path)
    _refuse_others(source.data, path)
    with line_numbers(source.lines):
        return _checked(source, path, list(settings))


def _refuse_others(data: Mapping[str, Any], path: Path) -> None:
    """A line that says the right command for a file of another kind.

    Raises:
        CaseError: it is one.
    """
    kinds = {"design": ("targets", "goals"), "sweep": ("vary", "zip", "points")}
    if HAND in data:
        return
    for kind, keys in kinds.items():
        if any(key in data for key in keys):
            raise CaseError([Problem(str(path), f"this is a {kind}: fiberbend {kind} {path}")])
    if "actuator" in data:
        raise CaseError([Problem(str(path), f"this is a case: fiberbend run {path}")])


def _checked(source: YamlContent, path: Path, settings: Sequence[str]) -> Hand:
    try:
        file = HandFile.model_validate(source.data)
    except ValidationError as error:
        raise CaseError(from_pydantic(error, HandFile)) from None
    wrong = list(problems(file))
    if wrong:
        raise CaseError(wrong)
    fingers: list[Finger] = []
    for number in range(len(file.fingers)):
        try:
            fingers.append(_finger(file, number, source, path, settings))
        except CaseError as error:
            wrong += error.problems
    if wrong:
        # what fingers of one case share is said once
        raise CaseError(dict.fromkeys(wrong))
    return Hand(
        file.title,
        tuple(fingers),
        file.objects.each,
        None if file.gravity is None else file.gravity.weight(),
        file.stiffness,
        file.output,
        _resolved(file, fingers),
    )


def _finger(
    file: HandFile, number: int, source: YamlContent, path: Path, settings: Sequence[str]
) -> Finger:
    """One finger.

    Raises:
        CaseError: everything that is wrong with its case.
    """
    spec = file.fingers[number]
    case = spec.case or file.case
    assert case is not None, "checked before"
    base = read_base(case, file.set | spec.set, source, path, settings)
    data = base.source.data
    pressure = spec.pressure if spec.pressure is not None else file.pressure
    wrong = list(_idle_changes(base, pressure))
    for part in _NOT_ASKED:
        data.pop(part, None)
    data["model"] = _MODEL
    wrong += _own_effects(data, base)
    if pressure is not None and not _inflate(data, pressure):
        wrong.append(base.reported(Problem("effects", "no pressure, expected one: {to: …}")))
    if wrong:
        raise CaseError(wrong)
    if file.gravity is not None:
        # its direction is the world's: it stands here for what a heavy case needs
        data.setdefault("effects", []).append({"gravity": {"direction": "-y"}})
    try:
        checked = parse_case(data)
    except CaseError as error:
        raise CaseError(base.reported(problem) for problem in error.problems) from None
    wrong = [base.reported(problem) for problem in _not_in_a_hand(checked, file)]
    if wrong:
        raise CaseError(wrong)
    return Finger(name_of(file, number), checked, spec.pose)


def _entries(data: dict[str, Any]) -> list[tuple[int, dict[str, Any]]]:
    """Effects of a case that is not yet checked, each with its place."""
    effects = data.get("effects")
    listed = effects if isinstance(effects, list) else []
    return [(n, entry) for n, entry in enumerate(listed) if isinstance(entry, dict)]


def _own_effects(data: dict[str, Any], base: BaseCase) -> Iterator[Problem]:
    """Weight that a finger has by itself: its axes are not those of the hand."""
    for number, entry in _entries(data):
        if GravityEffect.name in entry:
            text = "acts in the axes of the finger, expected gravity of the hand"
            yield base.reported(Problem(f"effects.{number}.{GravityEffect.name}", text))


def _idle_changes(base: BaseCase, pressure: float | None) -> Iterator[Problem]:
    """What is set for a hand and would change nothing, and a motion, which no hand has.

    Args:
        base: the case with its changes.
        pressure: that takes the place of the case's, or None.
    """
    data = base.source.data
    if "time" in data:
        text = "no effect in a hand, which is at rest, expected a case without"
        yield base.reported(Problem("time", text))
    inflated = [
        f"effects.{number}.{PressureEffect.name}"
        for number, entry in _entries(data)
        if PressureEffect.name in entry
    ]
    for path in dict.fromkeys(base.changed):
        part = path.partition(".")[0]
        if part in _IDLE or (part == "model" and data.get(part) != _MODEL):
            yield base.reported(Problem(path, "no effect in a hand, expected no such change"))
        elif pressure is not None and any(f"{path}.".startswith(f"{own}.") for own in inflated):
            text = "no effect beside pressure of the hand, expected one of the two"
            yield base.reported(Problem(path, text))


def _inflate(data: dict[str, Any], pressure: float) -> bool:
    """Gives a case another pressure; whether it has an effect pressure."""
    for _, entry in _entries(data):
        if PressureEffect.name in entry:
            entry[PressureEffect.name] = {"to": show(pressure, "pressure")}
            return True
    return False


def _not_in_a_hand(case: Case, file: HandFile) -> Iterator[Problem]:
    """Effects that a finger cannot have, and a chamber that no pressure drives."""
    load = case.inflation
    if load is None or load.to is None:
        text = "expected pressure with to: fingers are driven together, by pressures"
        yield Problem("effects", text)
    if not all(wound(zone).plane for zone in zone_cases(case)):
        yield Problem("effects", f"not known in a hand: {TOUCHED}")
    own = [effect for effect in case.effects if file.gravity is None or not effect.weight()]
    for number, effect in enumerate(own):
        if effect.inflation() is None and effect.beside() is None:
            text = "not known in a hand: its fingers have pressure and windings, it has objects"
            yield Problem(f"effects.{number}.{effect.name}", text)


def _resolved(file: HandFile, fingers: Sequence[Finger]) -> dict[str, Any]:
    """The file with every default, and the resolved case of every finger in place of its path."""
    content = file.model_dump(by_alias=True, exclude_none=True, mode="json")
    for key in ("case", "set", "pressure"):
        content.pop(key, None)
    for entry, finger in zip(content["fingers"], fingers, strict=True):
        entry.pop("set", None)
        entry["name"], entry["case"] = finger.name, finger.case.resolved()
    return content
