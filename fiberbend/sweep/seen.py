"""What a sweep varies and its model hardly sees, and the model that does: asked of the models."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Iterator
from typing import Any

from fiberbend.case.case import Case
from fiberbend.models.choice import MODELS, choose_model
from fiberbend.models.model import ModelKind
from fiberbend.reader.reader import parse_case
from fiberbend.schema.paths import put
from fiberbend.schema.problems import CaseError
from fiberbend.schema.units import show
from fiberbend.sweep.dry_run import in_words, seconds, together
from fiberbend.sweep.fields import VariedField
from fiberbend.sweep.points import Sweep, blocked_case

_FINE = 1 + 1e-9
_AXIAL = "mesh.axial"
_MOST = 200
"""Points of which another model's time is asked; of more it is scaled."""


@dataclasses.dataclass(frozen=True)
class _Answer:
    """Another model that sees a field.

    Attributes:
        model: its name.
        settings: changes to the base case with which it solves the points, by their paths.
        cases: what it would solve for each point.
    """

    model: str
    settings: dict[str, str]
    cases: list[tuple[Case, ...]]


def hardly_seen(sweep: Sweep, jobs: int = 1) -> list[str]:
    """A warning for each varied field that the sweep's model hardly sees.

    Args:
        sweep: the points.
        jobs: processes that solve at once, for the time of another model.

    Returns:
        Sentences: the field, the model, why, and the cheapest model that sees it, with its time.
    """
    found = []
    for field in sweep.columns:
        if len(set(field.values)) < 2:
            continue
        reasons = [
            _reason(choose_model(point.case)[0], point.case, field) for point in sweep.points
        ]
        if not all(reasons):
            # at some points it is seen: a comparison of models, or of threads stiff and soft
            continue
        names = sorted({choose_model(point.case)[0].name for point in sweep.points})
        text = f"{field.path} varies, which model {' and '.join(names)} hardly sees: {reasons[0]}"
        found.append(f"{text}; {_remedy(sweep, field, jobs)}")
    return found


def _reason(model: ModelKind, case: Case, field: VariedField) -> str:
    """Why a model hardly sees a field of a case; empty where it sees it."""
    found = {
        path: reason
        for path, reason in model.hardly_sees(case)
        if f"{field.path}.".startswith(f"{path}.")
    }
    # the reason that is nearest to the field
    return found[max(found, key=len)] if found else ""


def _remedy(sweep: Sweep, field: VariedField, jobs: int) -> str:
    """The cheapest model that sees a field, and how it is asked for."""
    answer = next(_seeing(sweep, field), None)
    if answer is None:
        return "no model sees more of it"
    times = [time for cases in answer.cases if (time := seconds(cases)) is not None]
    quoted = {path: f'"{v}"' if " " in v else v for path, v in answer.settings.items()}
    settings = " ".join(f"--set {path}={value}" for path, value in quoted.items())
    text = f"model {answer.model} sees it ({settings})"
    if not times:
        return text
    number = len(sweep.points)
    whole = together(times, jobs) * number / len(times)
    each = in_words(sum(times) / len(times))
    return f"{text}, {each} a point, {in_words(whole)} for {number}"


def _seeing(sweep: Sweep, field: VariedField) -> Iterator[_Answer]:
    """Models that see a field at every point, the cheapest first."""
    for model in MODELS.values():
        try:
            settings = _settings(sweep, model)
            cases = [_changed(point.given, settings) for point in sweep.points[:_MOST]]
            if any(_reason(model, case, field) for case in cases):
                continue
            blocked = [blocked_case(case, sweep.report) for case in cases]
        except CaseError:
            continue
        both: list[tuple[Case, ...]] = [
            (case,) if other is None else (case, other)
            for case, other in zip(cases, blocked, strict=True)
        ]
        yield _Answer(model.name, settings, both)


def _settings(sweep: Sweep, model: ModelKind) -> dict[str, str]:
    """What the points have to change for a model to resolve all that it can.

    Raises:
        CaseError: a point does not go with that.
    """
    settings, elements = {"model": model.name}, model.elements()
    layers = 0.0 if elements is None else elements.layers_a_pitch
    if not layers:
        return settings
    points = sweep.points[:_MOST]
    for point in points:
        for index, effect in enumerate(point.case.effects):
            for key, value in effect.in_turns().items():
                settings[f"effects.{index}.{effect.name}.{key}"] = value
    if any(field.path == _AXIAL for field in sweep.columns):
        return settings
    cases = [_changed(point.given, settings) for point in points]
    wanted = [(case, case.turns.spacing / layers) for case in cases if case.turns is not None]
    if any(case.mesh.axial > _FINE * length for case, length in wanted):
        settings[_AXIAL] = show(min(length for _, length in wanted), "length")
    return settings


def _changed(given: dict[str, Any], settings: dict[str, str]) -> Case:
    """The case of a point with other settings.

    Raises:
        CaseError: it does not go with them.
    """
    data = copy.deepcopy(given)
    for path, value in settings.items():
        put(data, path, value)
    return parse_case(data)
