"""Which rungs a case has: every model that supports it, with several meshes of each kind.

Models and effects are asked: what a model refuses is left out with its reason, and a winding has as
many representations as its key `as` takes.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.shapes import SHAPES
from fiberbend.case.zones import effects_of, zone_cases
from fiberbend.effects.wound.turns import Turns
from fiberbend.models.choice import MODELS
from fiberbend.models.model import MeshedModel, ModelKind
from fiberbend.plan.estimate import cost_of, steps_of_rod
from fiberbend.plan.memory import needed_mb
from fiberbend.reader.reader import as_case
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.units import show
from fiberbend.slender.kept import laws_to_make

BARE = (
    *("output.pictures=false", "output.fields=false", "output.report=false"),
    *("output.animation=false", "compare=[]"),
    # an accuracy that is asked for would choose model and mesh itself
    *(["accuracy=null"] if "accuracy" in Case.model_fields else []),
)
"""What every rung is solved with: times without drawing, and the mesh that it names."""
_LAYERS = (0.5, 1.0, 2.0)
"""Elements along the axis, over those that a model needs to resolve a turn."""
_EDGES = (0.25, 0.5, 1.0)
"""The same of elements with one size, which become smaller in all directions."""
_SPREAD = 0.8
"""Length of the longest elements over the half width of the section, without turns."""
_STEPS = 12
"""Load steps of a run whose steps cannot be predicted."""
_WORDS = {"smeared": "spread", "discrete": "turns"}
"""Words of the family for what a case calls otherwise."""
SECTION, AXIAL = "section", "axial"
"""The two directions in which a mesh is refined; keys of `mesh`."""


@dataclasses.dataclass(frozen=True)
class Family:
    """Rungs that differ in their mesh only.

    Attributes:
        model: name of the model.
        winding: 'turns', 'spread' or what else `as` says; empty without a winding.
        element: shape of the elements; empty where the model has one only, or none.
        half: half of what is modelled stands for all; None where the model leaves no choice.
    """

    model: str
    winding: str = ""
    element: str = ""
    half: bool | None = None

    @property
    def key(self) -> str:
        """Its name in file names and options, such as `body-turns-hexahedron-half`."""
        part = {None: "", True: "half", False: "full"}[self.half]
        return "-".join(filter(None, (self.model, self.winding, self.element, part)))

    @property
    def discretisation(self) -> Family:
        """What half and whole have in common: their answers agree to round-off."""
        return dataclasses.replace(self, half=None)


@dataclasses.dataclass(frozen=True)
class Rung:
    """A case with a model and a mesh.

    Attributes:
        family: what it shares with other meshes.
        settings: changes that make it, as `--set` takes them.
        case: the changed case, nothing drawn.
        mesh: size of the elements by direction, 1/elements through a thickness and mm; empty
            without elements.
        left_out: what the model leaves out of the case, a sentence each.
        unknowns: displacements and pressures.
        seconds: expected of its whole process.
        memory_mb: expected greatest memory.
    """

    family: Family
    settings: tuple[str, ...]
    case: Case
    mesh: dict[str, float]
    left_out: tuple[str, ...] = ()
    unknowns: int = 0
    seconds: float = 0.0
    memory_mb: float = 0.0

    @property
    def name(self) -> str:
        """Of its file: family and mesh."""
        parts = [self.family.key]
        if SECTION in self.mesh:
            parts.append(f"s{self.case.mesh.section}")
        if AXIAL in self.mesh:
            parts.append(f"a{self.case.mesh.axial:.4g}mm")
        return "-".join(parts)

    @functools.cached_property
    def digest(self) -> str:
        """Of its resolved case."""
        text = json.dumps(self.case.resolved(), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]


@dataclasses.dataclass(frozen=True)
class Missing:
    """A family or rung that the ladder does not have.

    Attributes:
        name: which.
        reason: why.
    """

    name: str
    reason: str


@dataclasses.dataclass(frozen=True)
class Ladder:
    """All that a case is solved by.

    Attributes:
        rungs: the cheapest first.
        missing: what the case has no rungs of, and why.
    """

    rungs: tuple[Rung, ...]
    missing: tuple[Missing, ...]


def ladder(source: Path | dict[str, Any], settings: Sequence[str] = ()) -> Ladder:
    """The rungs of a case.

    Args:
        source: the case file, or a case as a mapping.
        settings: changes to it.

    Raises:
        CaseError: the case itself is wrong.
    """
    base = as_case(source, settings)
    if base.time is not None:
        text = "a rod alone moves, and nothing is there to compare it with, expected a case without"
        raise CaseError([Problem("time", text)])
    rungs: list[Rung] = []
    missing: list[Missing] = []
    for family, changes in _families(base):
        try:
            found = list(_rungs(source, settings, family, changes, rungs))
        except _LeftOutError as why:
            missing.append(Missing(family.key, str(why)))
        else:
            rungs += found
    # half a body first: of two rungs that cost alike the one that others are compared with
    rungs.sort(key=lambda rung: (rung.seconds, rung.family.half is False))
    return Ladder(tuple(rungs), tuple(missing))


class _LeftOutError(Exception):
    """Why a case has no rungs of a family."""


def _families(base: Case) -> Iterator[tuple[Family, list[str]]]:
    """Every combination of model, winding, elements and halves, with its changes to the case."""
    paths, words = representations(base)
    # a case that asks for an accuracy would choose its mesh itself where a rung is typed by hand
    own = ["accuracy=null"] if base.accuracy is not None else []
    for name, model in MODELS.items():
        elements = model.elements()
        shapes: tuple[str, ...] = ("",)
        if elements is not None and elements.takes_mesh_as_given:
            shapes = tuple(SHAPES)
        for shape in shapes:
            for word in words:
                changes = [*own, f"model={name}"]
                if word:
                    changes += [f"{path}={word}" for path in paths]
                if shape:
                    changes.append(f"mesh.element={shape}")
                yield Family(name, _WORDS.get(word, word), shape), changes


def representations(case: Case) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Paths of the keys that say how windings are represented, and what they take.

    Returns:
        The paths, that of the case and those of zones with their own, and the words; one empty
        word for a case without a winding.
    """
    every = {f"effects.{n}.{effect.name}": effect for n, effect in enumerate(case.effects)}
    for number in range(len(case.zones or ())):
        every |= effects_of(case, number)
    paths: list[str] = []
    words: tuple[str, ...] = ("",)
    for path, effect in every.items():
        if not effect.winds():
            continue
        for field in type(effect).model_fields.values():
            if field.alias == "as":
                words = tuple(_literals(field.annotation))
                paths.append(f"{path}.as")
    return tuple(paths), words


def wound(case: Case) -> list[Turns]:
    """The windings of a case, or of all its zones."""
    return [zone.turns for zone in zone_cases(case) if zone.turns is not None]


def _literals(annotation: Any) -> Iterator[str]:
    if get_origin(annotation) is Literal:
        yield from get_args(annotation)
        return
    for part in get_args(annotation):
        yield from _literals(part)


def _rungs(
    source: Path | dict[str, Any],
    settings: Sequence[str],
    family: Family,
    changes: Sequence[str],
    before: Iterable[Rung],
) -> Iterator[Rung]:
    """The rungs of a family.

    Raises:
        _LeftOutError: it has none.
    """
    first = _read(source, settings, changes)
    model = MODELS[family.model]
    elements = model.elements()
    others = [rung.family for rung in before]
    if elements is None:
        if model.line and any(other.model == family.model for other in others):
            raise _LeftOutError("a closed form has no turns: the same as the rung before")
        yield _rung(first, family, changes, model)
        return
    _refuse_twice(first, family, elements, others)
    halved, _ = elements.half(first)
    wholes = (
        [halved] if not elements.takes_mesh_as_given else [halved, *([False] if halved else [])]
    )
    for half in wholes:
        own = dataclasses.replace(family, half=half if elements.takes_mesh_as_given else None)
        symmetry = [] if half == halved else ["mesh.symmetry=full"]
        meshes = list(_meshes(first, elements))
        if half != halved:
            # it differs in time and memory only: one mesh shows how much
            meshes = meshes[:1] if family.element == next(iter(SHAPES)) else []
        for mesh in meshes:
            more = [*changes, *symmetry, *(f"mesh.{key}={value}" for key, value in mesh.items())]
            yield _rung(_read(source, settings, more), own, more, model)


def _read(source: Path | dict[str, Any], settings: Sequence[str], changes: Sequence[str]) -> Case:
    try:
        return as_case(source, [*settings, *BARE, *changes])
    except CaseError as error:
        problem = error.problems[0]
        raise _LeftOutError(f"{problem.path}: {problem.text}") from None


def _refuse_twice(case: Case, family: Family, model: MeshedModel, others: Sequence[Family]) -> None:
    """Leave out a uniform model whose slice is alike along the axis: a cheaper one is the same."""
    resolved = any(turns.discrete for turns in wound(case))
    alike = not model.ends and model.layers_a_pitch > 0 and not resolved
    for other in others:
        cheaper = MODELS[other.model].elements()
        if alike and cheaper is not None and not cheaper.ends and other.winding == family.winding:
            text = f"without turns nothing varies along the axis: the same as {other.key}"
            raise _LeftOutError(text)


def _meshes(case: Case, model: MeshedModel) -> Iterator[dict[str, str]]:
    """Values of `mesh` from coarse to fine, each direction for itself, and a corner.

    The directions are refined one after the other from one mesh, so that each has its own limit;
    a uniform model has a mesh fine in both as well, by which it shows whether they add up.
    """
    every = {SECTION, AXIAL}
    given = case.mesh.model_copy(update={key: getattr(case.mesh, key) for key in every})
    unused = model.unused(case.model_copy(update={"mesh": given})).get("mesh", set())
    axials = [] if AXIAL in unused else _axials(case, model)
    most = 2 if model.shared else 3 if axials else 4
    sections = [] if SECTION in unused else [str(number) for number in range(1, most + 1)]
    if not axials or not sections:
        key, values = (SECTION, sections) if sections else (AXIAL, axials)
        yield from ({key: value} for value in values)
        return
    yield from ({SECTION: sections[0], AXIAL: axial} for axial in axials)
    if _one_size(case):
        return
    base = axials[0]
    if any(turns.discrete for turns in wound(case)):
        # where elements are too long for turns, what those of the section change is another thing:
        # of the baseline's body 1.1 % with one layer a half pitch, of its cell 0.03 % with four
        base = axials[-1] if model.shared else axials[1]
    yield from ({SECTION: section, AXIAL: base} for section in sections[1:])
    if not model.shared:
        yield {SECTION: sections[1], AXIAL: axials[-1]}


def _one_size(case: Case) -> bool:
    return SHAPES[case.mesh.element].one_size


def _axials(case: Case, model: MeshedModel) -> list[str]:
    """Lengths of the elements, halved twice: of a pitch's parts, or of the section's size."""
    spacings = [turns.spacing for turns in wound(case) if turns.discrete]
    least = min(spacings, default=math.inf)
    if math.isfinite(least):
        parts = _EDGES if _one_size(case) else _LAYERS
        lengths = [least / (model.layers_a_pitch * factor) for factor in parts]
    else:
        width = convert.dimensions(case.actuator).outline_half_width
        count = max(1, round(case.actuator.length / (_SPREAD * width)))
        lengths = [case.actuator.length / (count * factor) for factor in (1, 2, 4)]
    return [show(_up(length), "length") for length in lengths]


def _up(length: float) -> float:
    """Four digits, rounded up: rounded down there would be one element more."""
    step = 10.0 ** (math.floor(math.log10(length)) - 3)
    return float(f"{math.ceil(length / step * (1 - 1e-9)) * step:.4g}")


def _rung(case: Case, family: Family, changes: Sequence[str], model: ModelKind) -> Rung:
    left_out = tuple(f"{path}: {text}" for path, text in model.leaves_out(case))
    elements, rod = model.elements(), model.slender()
    if elements is None:
        seconds, memory, unknowns = model.start_s, needed_mb(case), 0
        if rod is not None:
            steps, (_, law_s) = steps_of_rod(case, rod), laws_to_make([case])
            seconds += (_STEPS if steps is None else steps) * rod.step_s + law_s
            unknowns = rod.unknowns(case)
        return Rung(family, tuple(changes), case, {}, left_out, unknowns, seconds, memory)
    size = elements.size(case)
    cost = cost_of(case, elements, size)
    expected = cost.seconds()
    seconds = cost.start_s + _STEPS * cost.step_s if expected is None else expected
    mesh = {}
    named = {change.partition("=")[0] for change in changes}
    if f"mesh.{SECTION}" in named and not _one_size(case):
        mesh[SECTION] = 1.0 / case.mesh.section
    if f"mesh.{AXIAL}" in named:
        mesh[AXIAL] = _length(case, elements)
    return Rung(
        family, tuple(changes), case, mesh, left_out, size.unknowns, seconds, cost.memory_mb
    )


def _length(case: Case, model: MeshedModel) -> float:
    """Length of the elements along the axis as they are made, mm."""
    if case.zones is not None and not model.ends:
        # each zone has a slice of its own, whose layers differ by less than one
        return case.mesh.axial
    axial = model.mesh_size(case, model.half(case)[0]).axial
    if not model.ends:
        return axial
    return case.actuator.length / math.ceil(case.actuator.length / axial - 1e-9)
