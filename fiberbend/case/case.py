"""A case as frozen objects, with floats in mm, N, MPa, rad, t/mm³ and mm/s².

The classes check single values. `fiberbend.reader.reader.parse_case` makes a case: it also checks
values against each other, and reports every problem at once.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

from pydantic import (
    AfterValidator,
    Field,
    field_serializer,
    field_validator,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError

from fiberbend.case.materials import Materials as Materials
from fiberbend.case.materials import MaterialSpec as MaterialSpec
from fiberbend.case.names import MODELS
from fiberbend.case.timed.spec import TimeSpec
from fiberbend.case.zone_spec import ZoneSpec as ZoneSpec
from fiberbend.effects.effect import Effect, Inflation, keep_straight
from fiberbend.effects.table import EffectEntry, unwrap
from fiberbend.effects.wound.turns import Turns
from fiberbend.schema.quantities import (
    Accuracy,
    Angle,
    BodyLength,
    Dimension,
    DimensionOrZero,
    Length,
    Pressure,
    SignedPressure,
    Spec,
    UnitName,
)
from geometry.sections.table import SECTIONS

E = TypeVar("E", bound=Effect)

if TYPE_CHECKING:
    AnyEffect = Effect
    ModelName = str
    SectionName = str
else:
    ModelName = Literal[(*MODELS, "auto")]
    SectionName = Literal[tuple(SECTIONS)]
    AnyEffect = Annotated[EffectEntry, AfterValidator(unwrap)]


class ActuatorSpec(Spec):
    """Dimensions of the actuator."""

    section: SectionName = "hemicircle"
    """Shape of the cross-section."""
    radius: Dimension | None = None
    """Radius of the chamber; hemicircle and circle."""
    width: Dimension | None = None
    """Width of the chamber; rectangle."""
    height: Dimension | None = None
    """Height of the chamber; rectangle."""
    length: BodyLength
    """Length of the chamber, without the caps."""
    wall: Dimension
    """Thickness of the wall around the chamber."""
    floor: DimensionOrZero | None = None
    """Thickness of the floor under the chamber; of a circle the outer part of the wall's thickness
    over the lowest quarter, none by default."""
    sheath: DimensionOrZero | None = None
    """Thickness of the sheath around everything; none by default."""
    cap: Dimension = 15.0
    """Length of each of the two solid end caps."""
    layer: DimensionOrZero | None = None
    """Thickness of a separate strain-limiting layer under a flat floor; none by default."""

    @field_validator("floor", "sheath", "layer")
    @classmethod
    def _none_if_zero(cls, value: float | None) -> float | None:
        """What has no thickness does not exist."""
        return value or None


class Mesh(Spec):
    """Fineness and shape of the elements."""

    element: Literal["hexahedron", "tetrahedron"] = "hexahedron"
    """Swept hexahedra, or tetrahedra."""
    axial: Length = 1.5
    """Greatest length of the elements along the axis; a discrete winding wants half its pitch."""
    section: int = Field(default=1, ge=1, le=16)
    """Refinement of the cross-section: elements through each thickness."""
    symmetry: Literal["auto", "half", "full"] = "auto"
    """Half the body where everything is mirror-symmetric, or as given."""


class Solver(Spec):
    """Steps and tolerance of the solution."""

    first_step: Pressure | None = None
    """First step of the pressure, by default from the linear response; under pressure control
    only."""
    max_step: Pressure | None = None
    """Greatest step of the pressure; without limit by default; under pressure control only."""
    max_turn: Angle | None = None
    """Greatest change of the bending angle in a step, of a body with zones that of the greatest
    turn along it; by default that of the model."""
    max_cutbacks: int = Field(default=8, ge=0, le=100)
    """How often in a row a step is cut before the run gives up."""
    tolerance: float = Field(default=1e-8, gt=0, le=1e-2)
    """Residual forces and volumes, each in units of its own internal force."""
    linear: Literal["direct", "iterative"] = "direct"
    """How linear systems of a body are solved: iterative shares a long body of hexahedra out over
    more than two ranks, but tells no stability, and refuses where it does not converge."""


class MeasuredSpec(Spec):
    """A file of measured points, and how to read it."""

    file: str
    """CSV file, relative to the case file; written alone where nothing else is given,
    `measured: trial.csv`."""
    pressure: str | None = None
    """Name of the column of pressures, such as "P [psi]"; pressure or P by default."""
    angle: str | None = None
    """Name of the column of bending angles; angle, theta or θ by default."""
    force: str | None = None
    """Name of the column of tip forces, where the tip is blocked; tip_force, force or F by
    default."""
    pressure_unit: Annotated[str, UnitName("pressure")] | None = None
    """Unit of the pressures, where their column's name does not have it."""
    angle_unit: Annotated[str, UnitName("angle")] | None = None
    """Unit of the angles, likewise."""
    force_unit: Annotated[str, UnitName("force")] | None = None
    """Unit of the forces, likewise."""
    delimiter: Literal["tab", "semicolon", "comma", "bar", "spaces"] | None = None
    """What stands between the columns; found from the lines by default."""
    decimal: Literal[".", ","] | None = None
    """The mark before decimals; found from the numbers by default."""

    def column(self, kind: str) -> tuple[str | None, str | None]:
        """Name and unit of the column of a quantity, 'pressure', 'angle' or 'force', as given."""
        return {
            "pressure": (self.pressure, self.pressure_unit),
            "angle": (self.angle, self.angle_unit),
            "force": (self.force, self.force_unit),
        }[kind]

    @model_validator(mode="before")
    @classmethod
    def _from_file(cls, data: Any) -> Any:
        if not isinstance(data, str | dict | MeasuredSpec):
            raise PydanticCustomError("measured", "expected the name of a file, or a mapping")
        return {"file": data} if isinstance(data, str) else data

    @model_serializer(mode="wrap")
    def _to_file(self, write: Any) -> Any:
        return self.file if self.model_fields_set == {"file"} else write(self)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: Any) -> dict[str, Any]:
        """A file alone is allowed too."""
        return {"anyOf": [{"type": "string"}, handler.resolve_ref_schema(handler(schema))]}


class Output(Spec):
    """What a run leaves beyond its curves."""

    at_angles: tuple[Angle, ...] = Field(default=(), strict=False)
    """Bending angles that are hit exactly wherever a load crosses them, up or down, with pictures
    and fields."""
    at_pressures: tuple[SignedPressure, ...] = Field(default=(), strict=False)
    """Pressures that are hit exactly, with pictures and fields."""
    stop_at_angle: Angle | None = None
    """The run ends where the pressure, or a load after it, crosses this bending angle, up or down;
    what is put on before the pressure is put on whole."""
    measured: MeasuredSpec | None = None
    """Measured points that are drawn over the curves and compared with them: a CSV file with
    columns of pressures and bending angles, or tip forces where the tip is blocked, and their
    units, such as pressure_kPa or "P [psi]"."""
    pictures: bool = True
    """Draw pictures."""
    animation: bool = False
    """Draw all load steps as an animation."""
    report: bool = True
    """Write report.html, a page with the answer, the curves and the body in space."""
    fields: bool = True
    """Write fields for ParaView, body and fibers at rest with their displacement."""
    field_steps: Literal["requested", "all"] = "requested"
    """States whose fields are written: rest, those asked for by angle or pressure and the last
    one, or all load steps; their time in ParaView is the number of the load step."""
    field_halves: Literal["modelled", "both"] = "modelled"
    """Fields of what is modelled, or, where that is one half, of it and its mirror image; of a
    body that is solved whole they are the same."""


class Case(Spec):
    """A whole case."""

    title: str = ""
    """A line for the reader."""
    actuator: ActuatorSpec
    """Dimensions."""
    materials: Materials
    """Material of each part."""
    effects: tuple[AnyEffect, ...] = Field(strict=False)
    """What acts on the body; loads are applied in this order, earlier ones kept."""
    zones: tuple[ZoneSpec, ...] | None = Field(default=None, strict=False)
    """Lengths of the chamber from root to tip, each with a winding and materials of its own."""
    support: Literal["clamped-root"] = "clamped-root"
    """How the body is supported."""
    model: ModelName = "auto"
    """Model to solve; auto takes the cheapest that supports every effect."""
    accuracy: Accuracy | None = None
    """Greatest error of what is asked for: model, mesh and winding that are not given are chosen
    for it, and the run reports its estimated error beside its result."""
    time: TimeSpec | None = None
    """Motion of a rod in time, with its mass and its damping; a state at rest unless given."""
    compare: tuple[Literal["paper"], ...] = Field(default=(), strict=False)
    """What a run is put beside on top of the cheaper models: the figures of the paper."""
    mesh: Mesh = Mesh.model_construct()
    """Elements."""
    solver: Solver = Solver.model_construct()
    """Steps and tolerance."""
    output: Output = Output.model_construct()
    """What the run leaves."""

    @field_serializer("effects")
    def _write_effects(self, effects: tuple[Effect, ...]) -> list[dict[str, Any]]:
        return [
            {effect.name: effect.model_dump(by_alias=True, exclude_none=True, mode="json")}
            for effect in effects
        ]

    def find(self, kind: type[E]) -> E | None:
        """The effect of a class, or None where the case does not list it."""
        return next((effect for effect in self.effects if isinstance(effect, kind)), None)

    @property
    def acting(self) -> tuple[Effect, ...]:
        """Effects that act anywhere along the length: the case's and those of its zones."""
        own = (effects for zone in self.zones or () for effects in zone.effects.values())
        return (*self.effects, *itertools.chain.from_iterable(own))

    @property
    def inflation(self) -> Inflation | None:
        """How the chamber is loaded, or None where it is not."""
        found = (effect.inflation() for effect in self.effects)
        return next((load for load in found if load is not None), None)

    @property
    def turns(self) -> Turns | None:
        """The thread around the body, or None where there is none; zones may have others."""
        from fiberbend.case import convert

        winding = next((effect for effect in self.effects if effect.winds()), None)
        return None if winding is None else winding.turns(convert.dimensions(self.actuator))

    @property
    def straight(self) -> bool:
        """An effect keeps the actuator from bending: its force is asked for, not its angle."""
        return keep_straight(self.effects)

    def resolved(self) -> dict[str, Any]:
        """The case with every default, as a mapping of plain values with units.

        Returns:
            What `fiberbend.reader.reader.parse_case` reads back to an equal case.
        """
        return self.model_dump(by_alias=True, exclude_none=True, mode="json")

    def _repr_html_(self) -> str:
        """What it says as a notebook shows it; what is seldom changed is folded."""
        from fiberbend.notebook import blocks

        said = {name: value for name, value in self.resolved().items() if value != []}
        title, seldom = said.pop("title", ""), ("mesh", "solver", "output", "support")
        rows = [(name, blocks.setting(value)) for name, value in said.items() if name != "effects"]
        at = 1 + [name for name, _ in rows].index("materials")
        rows[at:at] = [
            (name, blocks.setting(value))
            for effect in said["effects"]
            for name, value in effect.items()
        ]
        folded = [row for row in rows if row[0] in seldom]
        return blocks.block(
            title or "A case without a title",
            blocks.pairs([row for row in rows if row not in folded]),
            blocks.folded(", ".join(name for name, _ in folded), blocks.pairs(folded)),
        )
