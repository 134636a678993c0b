"""How far every rung is off: by its mesh, and by its model.

A family's limit is what its values tend to as the mesh is refined, direction by direction. The
**mesh error** of a rung is its distance from the limit of its own family, the **modelling error**
the distance of that limit from the limit of the finest family, which is the reference.
"""

from __future__ import annotations

import dataclasses
import math
import statistics
from collections.abc import Iterator, Mapping, Sequence

from fiberbend.case.shapes import SHAPES
from fiberbend.ladder.asked import Asked
from fiberbend.ladder.record import Record
from fiberbend.ladder.richardson import Limit, extrapolate, observed_order
from fiberbend.ladder.rungs import Family, Rung, wound
from fiberbend.models.choice import MODELS

_FEW = 3
ORDER = tuple(MODELS)
"""Models from the cheapest to the dearest."""
Solved = tuple[Rung, Record]


@dataclasses.dataclass(frozen=True)
class FamilyLimit:
    """The limit of a quantity in a family.

    Attributes:
        limit: of all directions together; its remark names those that are special.
        orders: observed, by direction.
    """

    limit: Limit
    orders: dict[str, float]


@dataclasses.dataclass(frozen=True)
class RungError:
    """How far a quantity of a rung is off, in percent of its scale in the reference; signed.

    Attributes:
        total: the value against the reference.
        mesh: the value against its family's limit; not a number where that is not known.
        model: that limit against the reference.
        unsure: how far the family's own limit may be off; nothing in the family of the reference,
            where it is what all errors are known to.
    """

    total: float
    mesh: float
    model: float
    unsure: float = 0.0

    @property
    def mesh_size(self) -> float:
        """|mesh|, but no less than the limit is unsure.

        The last of values that do not settle is not exact because it is taken for their limit.
        """
        return max(abs(self.mesh), self.unsure) if math.isfinite(self.mesh) else math.nan

    @property
    def size(self) -> float:
        """|mesh| + |model|: no credit for errors that cancel. |total| where they are not known."""
        both = self.mesh_size + abs(self.model)
        return both if math.isfinite(both) else abs(self.total)


@dataclasses.dataclass(frozen=True)
class Judged:
    """A rung with its errors.

    Attributes:
        rung: the rung.
        record: what it gave.
        errors: by the names of the quantities.
        flaw: why it cannot be chosen: it misses a quantity, or its family has no limit; empty where
            it can.
    """

    rung: Rung
    record: Record
    errors: dict[str, RungError]
    flaw: str = ""

    def worst(self, part: str = "size") -> float:
        """The greatest size of a part of the errors over the quantities, %."""
        sizes = [abs(getattr(error, part)) for error in self.errors.values()]
        return max(sizes, default=math.nan)


@dataclasses.dataclass(frozen=True)
class Judgement:
    """All rungs beside the reference.

    Attributes:
        asked: the quantities.
        reference: the family whose limits are the reference; None where nothing is comparable.
        limits: by family, half or whole, and quantity.
        rungs: every rung with an answer, as solved.
        finest: the family that would be the whole ladder's reference; None where not looked at.
    """

    asked: tuple[Asked, ...]
    reference: Family | None
    limits: dict[Family, dict[str, FamilyLimit]]
    rungs: tuple[Judged, ...]
    finest: Family | None = None

    def known_to(self) -> float:
        """Percent within which the reference itself is known, over all quantities."""
        found = self.limits[self.reference] if self.reference else {}
        return max(_uncertain(self.asked, found), default=math.inf)


def judge(
    asked: Sequence[Asked], solved: Sequence[Solved], every: Sequence[Rung] = ()
) -> Judgement:
    """Compare rungs with each other.

    Args:
        asked: the quantities; one of which the reference has no limit, or zero, is left out, and
            so is what hardly moves there.
        solved: the rungs that have an answer.
        every: all rungs of the case, solved or not; for `finest`.
    """
    limits = _limits(asked, solved)
    reference = _reference(asked, limits, solved)
    judged = []
    for rung, record in solved:
        own = limits.get(rung.family.discretisation, {})
        wanted = limits[reference] if reference else {}
        found = dict(_errors(record, own, wanted, scales(asked, wanted)))
        flaw = ""
        if reference is None or found.keys() != scales(asked, wanted).keys():
            flaw = "not all that is asked for"
        elif not all(math.isfinite(error.mesh) for error in found.values()):
            flaw = "mesh error not known"
        judged.append(Judged(rung, record, found, flaw))
    return Judgement(tuple(asked), reference, limits, tuple(judged), finest(every))


def scales(asked: Sequence[Asked], found: Mapping[str, FamilyLimit]) -> dict[str, float]:
    """What the error of each quantity is a part of, with the sign of the quantity.

    Its own limit, or the greatest of those that are judged together with it.

    Args:
        asked: the quantities; left out is one without a limit, and one that is too small to tell.
        found: the limits of a family.
    """
    sizes: dict[str, float] = {}
    for each in asked:
        if each.name in found:
            key = each.together or each.name
            sizes[key] = max(sizes.get(key, 0.0), abs(found[each.name].limit.value))
    return {
        each.name: math.copysign(sizes[each.together or each.name], found[each.name].limit.value)
        for each in asked
        if each.name in found and sizes[each.together or each.name] > each.least
    }


def _uncertain(asked: Sequence[Asked], found: Mapping[str, FamilyLimit]) -> list[float]:
    """Percent by which limits of a family may be off, of those that have a scale."""
    return [
        100 * found[name].limit.uncertainty / abs(scale)
        for name, scale in scales(asked, found).items()
    ]


def finest(rungs: Sequence[Rung]) -> Family | None:
    """Of the dearest model that of every turn by itself; of several the first."""
    known = [rung for rung in rungs if rung.mesh]
    best = max(
        known, key=lambda rung: (ORDER.index(rung.family.model), _discrete(rung)), default=None
    )
    if best is None:
        return None
    same = (rung.family for rung in known if rung.family.model == best.family.model)
    first = min(
        (family for family in same if family.winding == best.family.winding),
        key=_shape,
    )
    return first.discretisation


def _shape(family: Family) -> int:
    return list(SHAPES).index(family.element) if family.element else 0


def _discrete(rung: Rung) -> bool:
    return any(turns.discrete for turns in wound(rung.case))


def _errors(
    record: Record,
    own: Mapping[str, FamilyLimit],
    reference: Mapping[str, FamilyLimit],
    scale: Mapping[str, float],
) -> Iterator[tuple[str, RungError]]:
    for name, size in scale.items():
        goal, value = reference[name].limit.value, record.values.get(name)
        if value is None:
            continue
        limit = own[name].limit if name in own else Limit(math.nan, math.inf)
        known = math.isfinite(limit.uncertainty)
        mesh = (value - limit.value) / size if known else math.nan
        model = (limit.value - goal) / size if known else math.nan
        unsure = limit.uncertainty / abs(size) if known and own is not reference else 0.0
        yield (
            name,
            RungError(*(100 * part for part in ((value - goal) / size, mesh, model, unsure))),
        )


def _limits(
    asked: Sequence[Asked], solved: Sequence[Solved]
) -> dict[Family, dict[str, FamilyLimit]]:
    """Limits of all families; where two meshes tell no order, that of other families is used."""
    families = dict.fromkeys(rung.family.discretisation for rung, _ in solved)
    orders: dict[str, list[float]] = {}
    for family in families:
        for each in asked:
            for direction, line in _lines(_points(family, each, solved)).items():
                if len(line) >= _FEW:
                    sizes, values = zip(*line[-_FEW:], strict=True)
                    order = observed_order(sizes, values)
                    if order is not None and 0 < order < math.inf:
                        orders.setdefault(direction, []).append(order)
    known = {direction: statistics.median(found) for direction, found in orders.items()}
    limits: dict[Family, dict[str, FamilyLimit]] = {}
    for family in families:
        for each in asked:
            points = _points(family, each, solved)
            if points:
                limits.setdefault(family, {})[each.name] = family_limit(points, known)
    return limits


Point = tuple[Mapping[str, float], float]
"""Sizes of the elements by direction, and a value."""


def _points(family: Family, asked: Asked, solved: Sequence[Solved]) -> list[Point]:
    """A quantity on the meshes of a family; of half and whole one, for they agree."""
    found: dict[tuple[float, ...], Point] = {}
    for rung, record in solved:
        if rung.family.discretisation == family and asked.name in record.values:
            point = (rung.mesh, record.values[asked.name])
            found.setdefault(tuple(rung.mesh.values()), point)
    return list(found.values())


def _lines(points: Sequence[Point]) -> dict[str, list[tuple[float, float]]]:
    """Size and value along each direction through one mesh, from coarse to fine.

    That mesh, the base, is the one through which the longest lines go; of several the coarsest.
    """
    directions = list(dict.fromkeys(name for mesh, _ in points for name in mesh))

    def line(base: Mapping[str, float], along: str) -> list[tuple[float, float]]:
        others = [name for name in directions if name != along]
        found = [
            (mesh[along], value)
            for mesh, value in points
            if all(mesh[name] == base[name] for name in others)
        ]
        return sorted(found, reverse=True)

    def reach(base: Mapping[str, float]) -> tuple[int, float]:
        return sum(len(line(base, name)) for name in directions), math.prod(base.values())

    base = max((mesh for mesh, _ in points), key=reach, default={})
    return {name: line(base, name) for name in directions}


def family_limit(points: Sequence[Point], orders: Mapping[str, float] | None = None) -> FamilyLimit:
    """The limit of values on meshes that are refined in several directions.

    The directions add up: f = f₀ + Σ C_d h_dᵖ. A mesh that is fine in several of them shows whether
    they do; by as much as they do not the limit is uncertain, and from there the rest is taken.

    Args:
        points: sizes by direction, and values.
        orders: known of other families, by direction.
    """
    lines = _lines(points)
    if not lines:
        return FamilyLimit(Limit(points[0][1], 0.0), {})
    limits, found = {}, {}
    for name, line in lines.items():
        sizes, values = zip(*line, strict=True)
        limits[name] = extrapolate(sizes, values, (orders or {}).get(name))
        order = limits[name].order
        if order is not None:
            found[name] = order
    uncertain = sum(limit.uncertainty for limit in limits.values())
    remark = "; ".join(f"{name}: {limit.remark}" for name, limit in limits.items() if limit.remark)
    if not math.isfinite(uncertain):
        finest = min(points, key=lambda point: math.prod(point[0].values()))
        return FamilyLimit(Limit(finest[1], math.inf, remark=remark), found)
    base = _base(points, lines)
    value = base + sum(limit.value - base for limit in limits.values())
    corner = _corner(points, lines)
    if corner is not None:
        mesh, at_corner = corner
        here = {name: dict(line)[mesh[name]] for name, line in lines.items()}
        together = base + sum(there - base for there in here.values())
        value = at_corner + sum(limits[name].value - here[name] for name in lines)
        uncertain += abs(at_corner - together)
    return FamilyLimit(Limit(value, uncertain, remark=remark), found)


def _base(points: Sequence[Point], lines: Mapping[str, Sequence[tuple[float, float]]]) -> float:
    """The value on the mesh that all lines go through."""
    return next(
        value
        for mesh, value in points
        if all((mesh[name], value) in line for name, line in lines.items())
    )


def _corner(
    points: Sequence[Point], lines: Mapping[str, Sequence[tuple[float, float]]]
) -> Point | None:
    """The finest mesh that is refined in every direction by sizes that each line has."""

    def refined(mesh: Mapping[str, float]) -> bool:
        known = ((mesh[name], dict(line)) for name, line in lines.items())
        return all(size in line and size < max(line) for size, line in known)

    found = [point for point in points if len(lines) > 1 and refined(point[0])]
    return min(found, key=lambda point: math.prod(point[0].values()), default=None)


def _reference(
    asked: Sequence[Asked],
    limits: Mapping[Family, Mapping[str, FamilyLimit]],
    solved: Sequence[Solved],
) -> Family | None:
    """The finest family: of the dearest model, every turn by itself, most known, sharpest limit.

    The usual shape of elements before others, as `finest` has it.
    """
    rank = {}
    for family, found in limits.items():
        if MODELS[family.model].elements() is None:
            # a closed form knows itself to all digits, and nothing else
            continue
        unsure = _uncertain(asked, found)
        if not unsure or not all(map(math.isfinite, unsure)):
            continue
        own = (rung for rung, _ in solved if rung.family.discretisation == family)
        discrete = any(map(_discrete, own))
        sharp = max(unsure)
        rank[family] = (ORDER.index(family.model), discrete, len(unsure), -_shape(family), -sharp)
    return max(rank, key=lambda family: rank[family], default=None)
