"""Inextensible thread around wall and floor, between the caps."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import Field

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
    Turns,
)
from fiberbend.effects.thread import BulgingSpec, FiberSpec
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import Length, LengthOrZero
from fiberbend.schema.units import show
from geometry.winding.patterns import PATTERNS, least_pitch, turn_spacing

if TYPE_CHECKING:
    PatternName = str
    from geometry.actuator import Actuator
    from geometry.mesh.data import Floats, MeshData
    from geometry.winding.helix import Winding
    from materials.bulging import Bulging
else:
    PatternName = Literal[tuple(PATTERNS)]

Kind = Literal["discrete", "calibrated", "smeared"]

DEFAULT_LINES = 5
DISCRETE: Kind = "discrete"
CALIBRATED: Kind = "calibrated"
SMEARED: Kind = "smeared"
_POINTS_A_TURN = 24
_ROUNDING = 1e-9
_STIFF = 1e3
"""Modulus in MPa from which a thread hardly stretches."""


class WindingEffect(Effect):
    """Inextensible thread around wall and floor (and layer), between the caps."""

    name = "winding"

    pattern: PatternName
    """Double helix: one right-handed and one left-handed, crossing on the plane of symmetry."""
    pitch: Length
    """Length along the axis of one turn."""
    fiber: FiberSpec
    """A named fiber or its modulus and diameter."""
    representation: Kind | None = Field(default=None, alias="as")
    """Every turn by itself (discrete); the same thread spread over its surface, with rubber that
    bulges between the turns as in the cell of this section, which is solved before (calibrated); or
    spread alone (smeared). By default every turn where the model has turns, and smeared in the
    models section and analytic."""
    bulging: BulgingSpec | None = None
    """How stiff that rubber is, where it is known: no cell is solved; calibrated only."""
    width: LengthOrZero | None = None
    """Width of the ribbon that stands for the thread, its diameter by default; discrete, or in the
    cell of a calibrated winding. "0 mm" makes it a line, under which the pressure drifts with the
    mesh."""
    lines: int | None = Field(default=None, ge=1)
    """Parallel curves across the ribbon, 5 by default; likewise."""
    tension_only: bool = False
    """The thread goes slack instead of carrying compression."""

    @property
    def _twists(self) -> bool:
        return not PATTERNS[self.pattern].mirrored

    def needs(self) -> dict[str, str]:
        """Turns where every one is to lie by itself, twist where the pattern has a hand."""
        needed = {WOUND: "it has no thread around the body"}
        if self.representation == DISCRETE:
            needed[TURNS] = (
                "only cell and body have turns (as: calibrated, as: smeared, or leave `as` to the "
                "model)"
            )
        if self.representation == CALIBRATED:
            needed[THREAD] = "in closed forms no rubber bulges between turns (leave out `as`)"
        if self._twists:
            needed[TWIST] = "the closed form has no twist"
        return needed

    def wants(self) -> dict[str, str]:
        """A thread of its own pitch and stretch."""
        return {THREAD: "in closed forms a winding has neither pitch nor stretch (effect hoops)"}

    def hardly_felt(self, resolved: bool) -> dict[str, str]:
        """Of a stiff thread its modulus; spread over the surface, also what lies between turns."""
        felt = {}
        stiff = self.fiber.thread().modulus >= _STIFF
        if not resolved:
            felt["pitch"] = (
                "its winding is spread over the surface, so that no rubber bulges between the "
                "turns: a pitch of 1.5 to 6 mm moves the pressure for 90° by 1 %, by 11 % where "
                "every turn lies by itself (docs/sweep.md)"
            )
            spread = "its winding is spread over the surface, without a width"
            felt |= dict.fromkeys(("width", "lines"), spread)
            if stiff:
                felt["fiber"] = (
                    "its winding is spread over the surface, and its thread hardly stretches: a "
                    "diameter of 0.1 to 1 mm moves the pressure for 90° by +1 %, by −3 % where "
                    "every turn lies by itself (docs/sweep.md)"
                )
        if stiff:
            felt["fiber.modulus"] = (
                "a thread of 1 GPa or more hardly stretches: 1 to 300 GPa move the pressure for "
                "90° by 1 % in every model (docs/sweep.md)"
            )
        return felt

    def in_turns(self) -> dict[str, Any]:
        """Every turn by itself."""
        turns = self.turns()
        return {} if turns.discrete or turns.bulges else {"as": DISCRETE}

    def mirror_breaker(self) -> str:
        """A pattern with a hand."""
        meaning = PATTERNS[self.pattern].meaning
        return f"{meaning} is not its own mirror image" if self._twists else ""

    def end_breaker(self) -> str:
        """The same: both mirror planes change the hand."""
        return self.mirror_breaker()

    def turn_breaker(self) -> str:
        """Half a turn keeps the hand, and moves starts where turns lie by themselves."""
        pattern = PATTERNS[self.pattern]
        if pattern.turned or (self.representation is not None and not self.turns().discrete):
            return ""
        return f"half a turn about y does not map {pattern.meaning} onto itself"

    def bends(self) -> bool:
        """Half a turn about the axis maps every pattern onto itself, half a pitch on."""
        return False

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """Ribbon and thread, and whether there is room for them."""
        idle = {}
        if self.bulging is not None:
            idle = dict.fromkeys(("width", "lines"), "where bulging is given and no cell solved")
        if self.representation == SMEARED:
            idle = dict.fromkeys(("width", "lines", "bulging"), "on a smeared winding")
        elif self.representation == DISCRETE:
            idle = {"bulging": "where every turn lies by itself"}
        for key, where in idle.items():
            if getattr(self, key) is not None:
                yield Problem(f"{path}.{key}", f"no effect {where}, expected no value")
        if self.representation != SMEARED and self.width == 0 and (self.lines or 1) > 1:
            yield Problem(f"{path}.lines", f"{self.lines}, expected 1 line where the width is zero")
        if self.bulging is not None:
            yield from self.bulging.problems(f"{path}.bulging")
        wrong = list(self.fiber.problems(f"{path}.fiber"))
        yield from wrong
        if draft.actuator is None:
            return
        wanted = self.representation or (None if self.bulging is None else CALIBRATED)
        if wanted == CALIBRATED and not _rounded(draft.actuator):
            yield Problem(
                f"{path}.as",
                '"calibrated", but the thread is straight apart from corners, where it presses on '
                "no length of rubber: expected discrete or smeared",
            )
        if not wrong:
            yield from self._room(path, draft.actuator)

    def _room(self, path: str, actuator: Actuator) -> Iterator[Problem]:
        """A thread or ribbon that lies over itself, or that no place around the body holds."""
        diameter, width = self.fiber.thread().diameter, self.width or 0.0
        wide, what = (diameter, "thread") if diameter >= width else (width, "ribbon")
        perimeter = actuator.winding_perimeter
        apart = turn_spacing(self.pattern, self.pitch, perimeter)
        if wide > apart * (1 + _ROUNDING):
            least = least_pitch(self.pattern, wide, perimeter)
            wanted = f"a thinner {what}"
            if least is not None:
                wanted = f'at least "{show(_rounded_up(least), "length")}" or {wanted}'
            yield Problem(
                f"{path}.pitch",
                f'"{show(self.pitch, "length")}" lays the turns over each other, {apart:.3g} mm '
                f"apart where the {what} is {wide:.3g} mm wide, expected {wanted}",
            )
        if actuator.sheath is not None:
            under = min(actuator.wall, actuator.profile.bottom - actuator.outline_bottom)
            most, place = under + actuator.sheath, "wall or floor and sheath together"
        else:
            high = actuator.outline_top - actuator.outline_bottom
            most, place = min(2 * actuator.outline_half_width, high), "the body within"
        if diameter > most * (1 + _ROUNDING):
            yield Problem(
                f"{path}.fiber",
                f"a thread {diameter:.4g} mm thick, expected one not thicker than {place}, "
                f"{most:.4g} mm",
            )

    def completed(self, offers: frozenset[str] | None) -> Self:
        """As finely as the model can have it; every turn where the model is to be chosen."""
        fiber = self.fiber
        if fiber.name is None and fiber.radius_factor is None:
            fiber = fiber.model_copy(update={"radius_factor": 1.0})
        kind = self.representation
        if kind is None:
            ribbon = self.width is not None or self.lines is not None
            spread = offers is not None and TURNS not in offers and not ribbon
            kind = SMEARED if spread else DISCRETE
            if self.bulging is not None:
                kind = CALIBRATED
        update: dict[str, Any] = {"fiber": fiber, "representation": kind}
        if kind == DISCRETE or (kind == CALIBRATED and self.bulging is None):
            width = fiber.thread().diameter if self.width is None else self.width
            update["width"] = width
            update["lines"] = self.lines or (DEFAULT_LINES if width else 1)
        return self.model_copy(update=update)

    def representations(self) -> tuple[Self, ...]:
        """Spread and in turns, unless the case says which; a ribbon lies in turns."""
        given = {"representation", "width", "lines", "bulging"} & self.model_fields_set
        if given:
            return (self,)
        plain = self.model_copy(update={"width": None, "lines": None})
        kinds = (SMEARED, CALIBRATED, DISCRETE)
        return tuple(plain.model_copy(update={"representation": kind}) for kind in kinds)

    def turns(self) -> Turns:
        """Pitch, pattern and thread."""
        discrete = self.representation in (DISCRETE, None)
        thread = self.fiber.thread()
        lines = (self.lines or DEFAULT_LINES) if discrete else 1
        return Turns(
            self.pitch,
            discrete,
            self._twists,
            thread.stiffness,
            thread.modulus,
            lines * len(PATTERNS[self.pattern].helices),
            bulges=self.representation == CALIBRATED,
        )

    def fixes_circumference(self) -> bool:
        """Its thread hardly stretches."""
        return True

    def assumed(self) -> Iterator[str]:
        """Rigid, without pitch and twist."""
        yield "the winding fixes the circumference; its pitch does not enter"
        if self._twists:
            yield f"the twist of {PATTERNS[self.pattern].meaning} is not in it"

    def curves(self, actuator: Actuator) -> list[Floats]:
        """The axis of every fiber."""
        helix, turns = self.helix(), math.ceil(actuator.length / self.pitch)
        count = turns * _POINTS_A_TURN
        return [helix.points(actuator, curve, count)[0] for curve in range(helix.curves)]

    def follows_section(self) -> bool:
        """A body that twists leaves the plane of its section."""
        return not self._twists

    def beside(self) -> WindingEffect:
        """The same thread, spread; calibrated as it is."""
        if self.representation == CALIBRATED:
            return self
        return self.model_copy(update={"representation": SMEARED, "width": None, "lines": None})

    def uncalibrated(self) -> bool:
        """Where it is to be calibrated and nobody has given the numbers."""
        return self.representation == CALIBRATED and self.bulging is None

    def bulges(self) -> Bulging | None:
        """As the case or a calibration gives it."""
        return None if self.bulging is None else self.bulging.bulging()

    def in_cell(self) -> WindingEffect:
        """Every turn by itself."""
        return self.model_copy(update={"representation": DISCRETE, "bulging": None})

    def with_bulging(self, bulging: Bulging) -> WindingEffect:
        """Spread, with rubber that bulges; what the cell alone needs is gone."""
        return self.model_copy(
            update={
                "representation": CALIBRATED,
                "bulging": BulgingSpec.of(bulging),
                "width": None,
                "lines": None,
            }
        )

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
        """The curves as the geometry takes them; a width of zero is one line."""
        from geometry.winding.helix import Winding

        width = self.width if self.width is not None else self.fiber.thread().diameter
        lines = self.lines if self.lines is not None else DEFAULT_LINES
        return Winding(self.pattern, self.pitch, width, lines if width > 0 else 1)

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """The thread on the faces of the mesh."""
        from fem.effects.winding import CalibratedWinding, SmearedWinding, Winding
        from geometry.winding.embed import embed
        from geometry.winding.smear import smear

        actuator, helix = site.actuator, self.helix()
        stiffness, slack = self.fiber.thread().stiffness, self.tension_only
        if self.turns().discrete:
            turns = embed(mesh, actuator, helix)
            return Built((Winding(turns, stiffness, slack),), (), turns)
        spread = smear(mesh, actuator, helix)
        if self.representation == SMEARED:
            return Built((SmearedWinding(spread, stiffness, slack),), (), spread, True)
        if self.bulging is None:
            raise ValueError("a winding that is to be calibrated is built after its cell")
        term = CalibratedWinding(spread, stiffness, self.bulging.bulging(), slack)
        return Built((term,), (), spread, True)


def _rounded(actuator: Actuator) -> bool:
    """Whether a thread around it is curved anywhere but at corners."""
    return any(side.center is not None for side in actuator.outline())


def _rounded_up(length: float) -> float:
    """The next length of four digits."""
    step = 10.0 ** (math.floor(math.log10(length)) - 3)
    return float(f"{math.ceil(length / step) * step:.4g}")
