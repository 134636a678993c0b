"""Inextensible thread around wall and floor, between the caps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import ConfigDict, Field

from fiberbend.effects.effect import (
    THREAD,
    TURNS,
    TWIST,
    WOUND,
    Built,
    Draft,
    Effect,
    Requests,
    Site,
    Stretch,
)
from fiberbend.effects.records import OUTLINE
from fiberbend.effects.wound import bedded, zoned
from fiberbend.effects.wound.by_families import ByFamilies
from fiberbend.effects.wound.by_pattern import ByPattern
from fiberbend.effects.wound.family import Around, FamilySpec, bend, fiber_problems
from fiberbend.effects.wound.felt import hardly_felt
from fiberbend.effects.wound.room import rounded
from fiberbend.effects.wound.thread import BeddingSpec, BulgingSpec, FiberSpec
from fiberbend.effects.wound.threads import Threads, stiffness_of
from fiberbend.effects.wound.turns import Turns
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import Length, LengthOrZero, Quantity
from geometry.winding.patterns import PATTERNS

if TYPE_CHECKING:
    PatternName = str
    from fem.effects.effect import Effect as Term
    from fiberbend.states.snapshot import FamilyLook
    from geometry.actuator import Actuator
    from geometry.mesh.data import Floats, MeshData
    from geometry.winding.helix import Winding
    from geometry.winding.segments import EmbeddedFibers
    from materials.bedding import Bedding
    from materials.bulging import Bulging
else:
    PatternName = Literal[tuple(PATTERNS)]

Kind = Literal["discrete", "calibrated", "smeared"]

DEFAULT_LINES = 5
DISCRETE: Kind = "discrete"
CALIBRATED: Kind = "calibrated"
SMEARED: Kind = "smeared"


class WindingEffect(Effect):
    """Inextensible thread around wall and floor (and layer), between the caps."""

    name = "winding"

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [{"required": ["pattern", "pitch", "fiber"]}, {"required": ["families"]}]
        }
    )

    pattern: PatternName | None = None
    """Double helix: one right-handed and one left-handed, crossing on the plane of symmetry;
    needed without families."""
    pitch: Length | None = None
    """Length along the axis of one turn; needed without families."""
    families: tuple[FamilySpec, ...] | None = Field(default=None, strict=False, min_length=1)
    """Threads of any angle, in place of pattern and pitch."""
    around: Around | None = None
    """Where families lie: all around, or wall, not under the floor; all by default."""
    fiber: FiberSpec | None = None
    """A named fiber or its modulus and diameter; needed unless every family has its own."""
    representation: Kind | None = Field(default=None, alias="as")
    """Every turn by itself (discrete); the same thread spread over its surface, with rubber that
    bulges between the turns as in the cell of this section, which is solved before (calibrated); or
    spread alone (smeared). By default every turn where the model has turns, and smeared in the
    models section and analytic."""
    bulging: BulgingSpec | None = None
    """How stiff that rubber is, where it is known: no cell is solved; calibrated only."""
    bedding: BeddingSpec | None = None
    """The same under threads of families."""
    width: LengthOrZero | None = None
    """Width of the ribbon that stands for the thread, its diameter by default; discrete, or in the
    cell of a calibrated winding. "0 mm" makes it a line, under which the pressure drifts with the
    mesh."""
    lines: int | None = Field(default=None, ge=1)
    """Parallel curves across the ribbon, 5 by default; likewise."""
    tension_only: bool = False
    """The thread goes slack instead of carrying compression."""

    @property
    def _threads(self) -> Threads:
        """How they run, of a winding that is valid."""
        if self.families is None:
            assert self.pattern is not None
            assert self.pitch is not None
            return ByPattern(self.pattern, self.pitch, self._made_of(None).thread())
        each = tuple(self._made_of(family).thread() for family in self.families)
        return ByFamilies(self.families, each, self.around or "all")

    def _made_of(self, family: FamilySpec | None) -> FiberSpec:
        own = None if family is None else family.fiber
        fiber = self.fiber if own is None else own
        assert fiber is not None
        return fiber

    @property
    def _breaker(self) -> str:
        """Why it is not its own mirror image, so that it may twist; empty where it is."""
        return self._threads.breaker(self._spread)

    def needs(self) -> dict[str, str]:
        """Turns where every one is to lie by itself, twist where the pattern has a hand."""
        needed = {WOUND: "it has no thread around the body"}
        if self.representation == DISCRETE and not self._threads.upright:
            needed[TURNS] = (
                "only cell and body have turns (as: calibrated, as: smeared, or leave `as` to the "
                "model)"
            )
        if self.representation == CALIBRATED:
            needed[THREAD] = "in closed forms no rubber bulges between turns (leave out `as`)"
            if self.families is not None:
                needed[OUTLINE] = "families are calibrated in a section (as: discrete or smeared)"
        if self._breaker:
            needed[TWIST] = "the closed form has no twist"
        return needed

    def wants(self) -> dict[str, str]:
        """A thread of its own pitch and stretch."""
        return {THREAD: "in closed forms a winding has neither pitch nor stretch (effect hoops)"}

    def hardly_felt(self, resolved: bool) -> dict[str, str]:
        """Of a stiff thread its modulus; spread over the surface, also what lies between turns."""
        made_of = None if self.families is not None else self._made_of(None)
        return hardly_felt(made_of, resolved)

    def in_turns(self) -> dict[str, Any]:
        """Every turn by itself."""
        return {"as": DISCRETE} if self.representation == SMEARED else {}

    def mirror_breaker(self) -> str:
        """A pattern with a hand, families that are not balanced; nothing is known of wrong ones."""
        return "" if any(self._wrong("")) else self._breaker

    def end_breaker(self) -> str:
        """Mirror planes across the axis change the hand too, and leave threads along it."""
        return self._threads.end_breaker(self._spread)

    def turn_breaker(self) -> str:
        """Half a turn keeps the hand, and moves starts where turns lie by themselves."""
        return self._threads.turn_breaker(self._spread)

    @property
    def _spread(self) -> bool:
        return self.representation not in (DISCRETE, None)

    def bends(self) -> bool:
        """Where its threads are not alike above and below."""
        return bend(self.families or (), self.around)

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """Ribbon and thread, and whether there is room for them."""
        idle = {}
        if self.numbers is not None:
            idle = dict.fromkeys(("width", "lines"), "where bulging is given and no cell solved")
        if self.representation == SMEARED:
            keys = ("width", "lines", "bulging", "bedding")
            idle = dict.fromkeys(keys, "on a smeared winding")
        elif self.representation == DISCRETE:
            idle = dict.fromkeys(("bulging", "bedding"), "where every turn lies by itself")
        for key, where in idle.items():
            if getattr(self, key) is not None:
                yield Problem(f"{path}.{key}", f"no effect {where}, expected no value")
        if self.representation != SMEARED and self.width == 0 and (self.lines or 1) > 1:
            yield Problem(f"{path}.lines", f"{self.lines}, expected 1 line where the width is zero")
        slack = self.tension_only and self._wanted == CALIBRATED
        families, bedding = self.families is not None, self.bedding is not None
        yield from bedded.problems(path, families, self.bulging is not None, bedding, slack)
        if self.bulging is not None:
            yield from self.bulging.problems(f"{path}.bulging")
        wrong = list(self._wrong(path))
        yield from wrong
        if draft.actuator is None or wrong:
            return
        if self._wanted == CALIBRATED and not rounded(draft.actuator):
            yield Problem(
                f"{path}.as",
                '"calibrated", but the thread is straight apart from corners, where it presses on '
                "no length of rubber: expected discrete or smeared",
            )
        yield from self._threads.room(path, draft.actuator, self.width or 0.0)

    def _wrong(self, path: str) -> Iterator[Problem]:
        yield from self._runs(path)
        yield from fiber_problems(path, self.fiber, self.families or ())

    @property
    def _wanted(self) -> Kind | None:
        """How it is represented, as far as the case says."""
        return self.representation or (None if self.numbers is None else CALIBRATED)

    @property
    def numbers(self) -> BulgingSpec | BeddingSpec | None:
        """What a calibration gives it."""
        return self.bulging if self.families is None else self.bedding

    def _runs(self, path: str) -> Iterator[Problem]:
        """Neither pattern nor families, or both; what is wrong with either."""
        if self.families is None:
            names = " or ".join(PATTERNS)
            length = Quantity("length").expected
            for key, text in {"pattern": f"{names}, or families", "pitch": length}.items():
                if getattr(self, key) is None:
                    yield Problem(f"{path}.{key}", f"missing, expected {text}")
            if self.around is not None:
                yield Problem(f"{path}.around", "no effect without families, expected no value")
            return
        for key in ("pattern", "pitch"):
            if getattr(self, key) is not None:
                yield Problem(f"{path}.{key}", "no effect beside families, expected no value")
        for number, family in enumerate(self.families):
            yield from family.problems(f"{path}.families.{number}")

    def completed(self, offers: frozenset[str] | None) -> Self:
        """As finely as the model can have it; every turn where the model is to be chosen."""
        kind = self.representation
        if kind is None:
            ribbon = self.width is not None or self.lines is not None
            spread = offers is not None and TURNS not in offers and not ribbon
            kind = SMEARED if spread else DISCRETE
            if self.numbers is not None:
                kind = CALIBRATED
        update: dict[str, Any] = {"representation": kind}
        if self.fiber is not None:
            update["fiber"] = self.fiber.plain()
        if self.families is not None:
            update["families"] = tuple(family.plain() for family in self.families)
        if kind == DISCRETE or (kind == CALIBRATED and self.numbers is None):
            width = self.width
            if width is None and self.families is None:
                width = self._made_of(None).thread().diameter
            update["width"] = width
            update["lines"] = self.lines or (1 if width == 0 else DEFAULT_LINES)
        return self.model_copy(update=update)

    def representations(self) -> tuple[Self, ...]:
        """Spread and in turns, unless the case says which; a ribbon lies in turns."""
        given = {"representation", "width", "lines", "bulging", "bedding"} & self.model_fields_set
        if given:
            return (self,)
        plain = self.model_copy(update={"width": None, "lines": None})
        kinds: tuple[Kind, ...] = (SMEARED, CALIBRATED, DISCRETE)
        if self.families is not None:
            kinds = (SMEARED, DISCRETE)
        return tuple(plain.model_copy(update={"representation": kind}) for kind in kinds)

    def winds(self) -> bool:
        """All around or around the wall."""
        return True

    def turns(self, actuator: Actuator) -> Turns:
        """Of pattern or families."""
        return self._threads.turns(
            actuator,
            discrete := self.representation in (DISCRETE, None),
            spread=self.representation == SMEARED,
            bulges=self.representation == CALIBRATED,
            lines=(self.lines or DEFAULT_LINES) if discrete else 1,
        )

    def fixes_circumference(self) -> bool:
        """Its thread hardly stretches."""
        return True

    def assumed(self) -> Iterator[str]:
        """Rigid, without pitch and twist."""
        yield from self._threads.assumed()

    def runs(self, actuator: Actuator) -> list[str]:
        """Every family by angle and pitch."""
        return self._threads.words(actuator.winding_perimeter)

    def looks(self, actuator: Actuator) -> list[FamilyLook]:
        """Angle and hand of each family."""
        return self._threads.looks(actuator)

    def curves(self, actuator: Actuator) -> list[Floats]:
        """The axis of every fiber."""
        return self._threads.curves(actuator, self.width, self._lines(self.width))

    def follows_section(self) -> bool:
        """A body that twists leaves the plane of its section."""
        return not self._breaker

    def beside(self) -> WindingEffect:
        """The same thread, spread; calibrated as it is."""
        if self.representation == CALIBRATED:
            return self
        return self.model_copy(update={"representation": SMEARED, "width": None, "lines": None})

    def spread(self) -> WindingEffect:
        """The same thread on rubber that does not bulge."""
        numbers = {"bulging": None, "bedding": None, "width": None, "lines": None}
        return self.model_copy(update={"representation": SMEARED, **numbers})

    def uncalibrated(self) -> bool:
        """Where it is to be calibrated and nobody has given the numbers."""
        return self.representation == CALIBRATED and self.numbers is None

    def bulges(self) -> Bulging | Bedding | None:
        """As the case or a calibration gives it."""
        return None if self.numbers is None else self.numbers.bulging()

    def in_cell(self) -> WindingEffect:
        """Every turn by itself."""
        return self.model_copy(
            update={"representation": DISCRETE, "bulging": None, "bedding": None}
        )

    def with_bulging(self, bulging: Bulging | Bedding) -> WindingEffect:
        """Spread, with rubber that bulges; what the cell alone needs is gone."""
        update = {"representation": CALIBRATED, "width": None, "lines": None}
        return self.model_copy(update=update | bedded.entry(bulging))

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """None: the model's own errors were measured with it."""
        yield from ()

    def alone(self) -> str:
        """The section has it too."""
        return ""

    def steps(self) -> int:
        """It is no load."""
        return 0

    def helix(self) -> Winding:
        """A pattern's curves as the geometry takes them; a width of zero is one line."""
        from geometry.winding.helix import Winding

        if self.pattern is None or self.pitch is None:
            raise ValueError("families are no pattern")
        width = self._made_of(None).thread().diameter if self.width is None else self.width
        return Winding(self.pattern, self.pitch, width, self._lines(width))

    def _lines(self, width: float | None) -> int:
        lines = self.lines if self.lines is not None else DEFAULT_LINES
        return 1 if width == 0 else lines

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """The thread on the faces of the mesh; threads at places of their own are never spread."""
        from fem.effects.winding import CalibratedWinding, SmearedWinding, Winding
        from geometry.winding.embed import embed_families
        from geometry.winding.smear import smear

        actuator, threads, slack = site.actuator, self._threads, self.tension_only
        laid = threads.ribbons(actuator, self.width, self._lines(self.width)).turned(site.origin)
        flat = mesh.nodes.shape[1] == 2
        if self.representation in (DISCRETE, None):
            segments, which = embed_families(mesh, actuator, laid)
            stiffness = stiffness_of(threads, laid, which)
            return Built((Winding(segments, stiffness, slack),), (), segments, flat)
        placed, spread = laid.chosen(places=True), laid.chosen(places=False)
        if self.uncalibrated():
            raise ValueError("a winding that is to be calibrated is built after its cell")
        if self.bulging is not None:
            (fiber,), over = threads.fibers, smear(mesh, actuator, laid)
            bulges = self.bulging.bulging()
            return Built((CalibratedWinding(over, fiber.stiffness, bulges, slack),), (), over, True)
        terms: list[Term] = []
        shown: list[EmbeddedFibers] = []
        if spread is not None:
            over = smear(mesh, actuator, spread)
            stiffness = stiffness_of(threads, spread, over.curve)
            if self.bedding is None:
                terms.append(SmearedWinding(over, stiffness, slack))
            else:
                terms.append(bedded.term(over, stiffness, self.bedding, spread, actuator))
            shown.append(over)
        if placed is not None:
            segments, which = embed_families(mesh, actuator, placed)
            stiffness = stiffness_of(threads, placed, which)
            terms.append(Winding(segments, stiffness, slack))
            shown.append(segments)
        return Built(tuple(terms), (), shown[0], spread is not None or flat)

    def unlike(self, other: Effect) -> str:
        """Threads differ in all but how they are represented."""
        return zoned.unlike(self, other)

    def build_along(self, zones: Sequence[Stretch], requests: Requests) -> Built:
        """Every thread ends at the borders of its zone."""
        return zoned.build(zones, requests, self.tension_only)
