"""Every column of history.csv: its name, unit, meaning, and who fills it.

A new column is a function and a line in `COLUMNS`. What is not in the table is not written. Columns
form groups; a model says which groups it fills, and no model is named here.
"""

from __future__ import annotations

import dataclasses
import functools
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from typing import Any, ClassVar, Protocol

STEP = "step"
PRESSURE = "pressure_kPa"
ANGLE = "angle_deg"
SIDE_ANGLE = "side_angle_deg"
TIP_X = "tip_x_mm"
TIP_Y = "tip_y_mm"
TIP_Z = "tip_z_mm"
VOLUME = "chamber_mm3"
TIP_FORCE = "tip_force_N"
ROOF_FORCE = "roof_force_N"
ITERATIONS = "newton_iterations"
DET_F = "min_det_F"
VOLUME_ERROR_ELEMENT = "volume_error_element"
VOLUME_ERROR = "volume_error"
FIBER_MIN = "fiber_min_N"
FIBER_MAX = "fiber_max_N"
UNIFORM_ANGLE = "uniform_angle_deg"
UNIFORM_SIDE = "uniform_side_angle_deg"
UNIFORM_TWIST = "uniform_twist_deg"
UNIFORM_STRETCH = "uniform_stretch"
AXIS_STRETCH = "axis_stretch"
FLOOR_STRETCH = "floor_stretch"
CROWN_STRETCH = "crown_stretch"
TWIST = "twist_deg"
MOMENT = "blocked_moment_Nmm"
AXIAL_FORCE = "axial_force_N"
MOMENT_X = "moment_x_Nmm"
MOMENT_Y = "moment_y_Nmm"
TORQUE = "torque_Nmm"
WORK = "work_mJ"
STORED = "stored_mJ"
MODES = "unstable_modes"
TIME = "time_s"
SPEED = "tip_speed_mm_per_s"
KINETIC = "kinetic_mJ"
ELASTIC = "elastic_mJ"
POTENTIAL = "potential_mJ"
AIR_WORK = "air_work_mJ"
LOADS_WORK = "loads_work_mJ"
DISSIPATED = "dissipated_mJ"
DRIFT = "balance_mJ"
BALANCE_FORCE = "balance_force"
BALANCE_MOMENT = "balance_moment"

CONTACT = ("y_N", "z_N", "moment_x_Nmm", "area_mm2", "gap_mm")
"""Ends of an obstacle's columns: force on the body, its moment, area that touches, least gap."""
_OBSTACLE = re.compile(rf"contact_(\w+?)_(?:{'|'.join(CONTACT)})")

RUN = "run"
"""Columns of every model."""
MIDDLE = "middle"
"""Columns of a model that separates the bend of the middle from that of the ends."""
TIMED = "timed"
"""Columns of a run in time."""
SOLVED = "solved"
"""Columns of a model that finds its states in equilibrium: of finite elements, or as a rod."""
OBSTACLES = "obstacles"
"""Columns of a model with ends that obstacles may touch."""
ELEMENTS = "elements"
"""Columns of a model of finite elements."""
UNIFORM = "uniform"
"""Columns of a model whose curvature and stretch are global unknowns."""
ZONES = "zones"
"""Columns of a model that may have zones along the length."""
BODY = "body"
"""Columns of a body in space, with its supports and obstacles."""

COUNTS = frozenset({STEP, ITERATIONS, MODES})
"""Columns of integers."""

Row = Mapping[str, Any]
"""A row of history.csv: values by the names of their columns; None or absent: not known."""
Read = Callable[[Any, Any], float | None]
"""Reads a value off a `fem.scene.Scene` and the `fem.march.records.State` at which it is; None
where there is none, and the row then has no such column."""


class Filler(Protocol):
    """A model, as far as columns go."""

    name: ClassVar[str]
    """What a case calls it."""
    fills: ClassVar[frozenset[str]]
    """Groups of columns that it fills."""


@dataclasses.dataclass(frozen=True)
class Column:
    """A column of history.csv.

    Attributes:
        name: as in the file's head; a part in braces stands for a name of the case, of letters,
            digits and "_".
        unit: of its values; empty for a number without one.
        meaning: what it is.
        group: models fill it that have the group among `fills`.
        always: the file has it, and in this order, also where no value is known.
        beside: it is another model's answer at the same row.
        read: gives the value; None where the model's gauge or the recorder fills it.

    Raises:
        ValueError: it reads itself off a scene, in the group of every model.
    """

    name: str
    unit: str
    meaning: str
    group: str = RUN
    always: bool = False
    beside: bool = False
    read: Read | None = None

    def __post_init__(self) -> None:
        if self.read is not None and self.group == RUN:
            raise ValueError(f"column {self.name}: a closed form has no scene to read it off")

    def names(self, key: str) -> bool:
        """Whether it is the column that a row calls so."""
        pattern = re.sub(r"\\\{\w+\\\}", r"[A-Za-z0-9_]+", re.escape(self.name))
        return re.fullmatch(pattern, key) is not None


COLUMNS = (
    Column(STEP, "", "number of the load step, 0 at rest", always=True),
    Column(PRESSURE, "kPa", "chamber pressure", always=True),
    Column(
        ANGLE,
        "°",
        "turn of the centre-line, z = 0 to L, about the section's own x, toward −y",
        always=True,
    ),
    Column(TIP_Y, "mm", "y of the centroid of the tip cap's outer face", always=True),
    Column(TIP_Z, "mm", "z of it", always=True),
    Column(VOLUME, "mm³", "volume of the chamber", always=True),
    Column(TIP_FORCE, "N", "force of the tip on the post; kept straight: M / L_f", always=True),
    Column(ITERATIONS, "", "Newton iterations of the step", always=True),
    Column(
        DET_F,
        "",
        "least det F at a point of quadrature; low beside a fiber on a coarse mesh",
        ELEMENTS,
        always=True,
    ),
    Column(
        FIBER_MIN, "N", "least axial force of a fiber, of each line of a ribbon", ELEMENTS, True
    ),
    Column(FIBER_MAX, "N", "greatest of them", ELEMENTS, True),
    Column(
        VOLUME_ERROR_ELEMENT,
        "",
        "greatest ∫ (J − 1) dV / V of an element, no sign; with a bulk modulus J − 1 − p/κ",
        ELEMENTS,
    ),
    Column(VOLUME_ERROR, "", "the same of all rubber together", ELEMENTS),
    Column(TIP_X, "mm", "x of the tip"),
    Column(SIDE_ANGLE, "°", "turn about its own y, toward x, where it leaves its plane", SOLVED),
    Column(TWIST, "°", "turn of the sections about the centre-line, likewise", SOLVED),
    Column(UNIFORM_ANGLE, "°", "L times the curvature of the middle half", MIDDLE),
    Column(UNIFORM_SIDE, "°", "the same of the side angle", BODY),
    Column(UNIFORM_TWIST, "°", "the same of the twist", BODY),
    Column(AXIS_STRETCH, "", "stretch of the centre-line, through the centroids", SOLVED),
    Column("zone_{zone}_angle_deg", "°", "the bending angle's part of a zone", ZONES),
    Column("zone_{zone}_twist_deg", "°", "the twist's part of a zone, likewise", ZONES),
    Column("zone_{zone}_stretch", "", "stretch of the centre-line of a zone", ZONES),
    Column(UNIFORM_STRETCH, "", "stretch of the middle half of it", BODY),
    Column(FLOOR_STRETCH, "", "stretch λ0 of the line y = 0", UNIFORM),
    Column(CROWN_STRETCH, "", "stretch of the highest line", UNIFORM),
    Column(WORK, "mJ", "work of the loads since rest, Σ ∫ q dQ", SOLVED),
    Column(STORED, "mJ", "stored energy", SOLVED),
    Column("energy_{effect}_mJ", "mJ", "potential of an effect", ELEMENTS),
    Column(
        "load_{load}",
        "",
        "a load beside the pressure, of gravity the share that acts; its unit ends the name",
        SOLVED,
    ),
    Column(
        "conjugate_{load}",
        "",
        "what it does work on, of gravity mJ; its unit ends the name",
        SOLVED,
    ),
    Column(MODES, "", "unstable modes with every load kept at its value", SOLVED),
    Column(ROOF_FORCE, "N", "force of the roof on the body", OBSTACLES),
    Column("clamp_force_x_N", "N", "force of the clamp on the body along x", BODY),
    Column("clamp_force_y_N", "N", "the same along y", BODY),
    Column("clamp_force_z_N", "N", "the same along z", BODY),
    Column("clamp_moment_x_Nmm", "N mm", "its moment about x, through x = y = z = 0", BODY),
    Column("clamp_moment_y_Nmm", "N mm", "its moment about y, likewise", BODY),
    Column("clamp_moment_z_Nmm", "N mm", "its moment about z, likewise", BODY),
    Column("contact_{obstacle}_y_N", "N", "force of an obstacle on the body along y", OBSTACLES),
    Column("contact_{obstacle}_z_N", "N", "the same along z", OBSTACLES),
    Column("contact_{obstacle}_moment_x_Nmm", "N mm", "its moment about x", OBSTACLES),
    Column("contact_{obstacle}_area_mm2", "mm²", "area at rest of what touches", OBSTACLES),
    Column(
        "contact_{obstacle}_gap_mm", "mm", "least gap; negative: how deep the body is", OBSTACLES
    ),
    Column(BALANCE_FORCE, "", "what is left of all forces, over their scale", BODY),
    Column(BALANCE_MOMENT, "", "what is left of all moments, over theirs", BODY),
    Column(MOMENT, "N mm", "moment about the centroid, kept straight", UNIFORM),
    Column(AXIAL_FORCE, "N", "axial force with which it pushes; tension is negative", ELEMENTS),
    Column(MOMENT_X, "N mm", "moment about the centroid with which it bends toward −y", ELEMENTS),
    Column(MOMENT_Y, "N mm", "the same about its own y, toward x", ELEMENTS),
    Column(TORQUE, "N mm", "torque with which it twists from x to y", ELEMENTS),
    Column(
        "section_kPa",
        "kPa",
        "P of the section model: uniform bending, winding smeared, no ends",
        beside=True,
    ),
    Column(
        "analytic_kPa",
        "kPa",
        "P of eq. (19), wall and sheath by their own laws, nothing fitted",
        beside=True,
    ),
    Column(
        "analytic_winding_kPa",
        "kPa",
        "the same, the pressure acting on all inside the winding",
        beside=True,
    ),
    Column(
        "analytic_paper_kPa",
        "kPa",
        "eq. (19) without its extra L, with the paper's μ̄ = 0.314 MPa",
        beside=True,
    ),
    Column("section_tip_force_N", "N", "M / L_f of the section model kept straight", beside=True),
    Column("analytic_tip_force_N", "N", "κ P / L_f", beside=True),
    Column(
        "analytic_winding_tip_force_N",
        "N",
        "the same, the pressure on all inside the winding",
        beside=True,
    ),
    Column(TIME, "s", "time", TIMED),
    Column(SPEED, "mm/s", "speed of the tip", TIMED),
    Column(KINETIC, "mJ", "kinetic energy", TIMED),
    Column(ELASTIC, "mJ", "elastic energy of the sections since rest", TIMED),
    Column(POTENTIAL, "mJ", "potential of weight, loads and contact since rest", TIMED),
    Column(AIR_WORK, "mJ", "∫ P dV that the air has done since the motion began", TIMED),
    Column(LOADS_WORK, "mJ", "the same of loads without a potential", TIMED),
    Column(DISSIPATED, "mJ", "what damping has taken since then", TIMED),
    Column(DRIFT, "mJ", "what the balance of these leaves open: 0 but for round-off", TIMED),
)
"""In the order of a row."""


def contact(obstacle: str, quantity: str) -> str:
    """The column of an obstacle.

    Args:
        obstacle: its name.
        quantity: of `CONTACT`.
    """
    return f"contact_{obstacle}_{quantity}"


def zone(number: int, quantity: str) -> str:
    """The column of a zone.

    Args:
        number: of the zone, from 0; columns count from 1, the zone at the root.
        quantity: end of its name, "angle_deg", "twist_deg" or "stretch".
    """
    return f"zone_{number + 1}_{quantity}"


def obstacles(rows: Iterable[Row]) -> list[str]:
    """Names of the obstacles that a history has columns of, in the order of the columns."""
    keys = dict.fromkeys(key for row in rows for key in row)
    return list(dict.fromkeys(match[1] for match in map(_OBSTACLE.fullmatch, keys) if match))


def energy_columns(keys: Iterable[str]) -> dict[str, str]:
    """The columns of the energies of effects.

    Args:
        keys: of the effects of a scene, such as "SmearedWinding" and "Elastic[neo-hookean]".

    Returns:
        A column for each key, "energy_smeared_winding_mJ" and "energy_elastic_neo_hookean_mJ"; the
        second key of the same letters gets a number, so that no two share a column.
    """
    columns: dict[str, str] = {}
    for key in keys:
        name, number = _plain(key), 2
        while f"energy_{name}_mJ" in columns.values():
            name, number = f"{_plain(key)}_{number}", number + 1
        columns[key] = f"energy_{name}_mJ"
    return columns


def load_columns(load: str, unit: str, conjugate_unit: str) -> tuple[str, str]:
    """The columns of a load's value and of its work-conjugate, with their units.

    Args:
        load: name of the global scalar, such as "gravity"; the pressure has columns of its own.
        unit: of the value; empty for a share.
        conjugate_unit: of the work-conjugate.
    """
    value, conjugate = (
        f"{kind}_{_plain(load)}" + ("_" if end else "") + end
        for kind, end in (("load", unit), ("conjugate", conjugate_unit))
    )
    return value, conjugate


def _plain(key: str) -> str:
    """A key as a part of a column: "Contact[left-post]" becomes contact_left_post."""
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", key)
    return re.sub(r"[^A-Za-z0-9]+", "_", words).strip("_").lower()


def present_name(key: str) -> str | None:
    """What a column of an older history.csv is called now; None where another one says the same.

    Raises:
        KeyError: neither this version nor an older one has such a column.
    """
    value, conjugate = load_columns("gravity", "", "mJ")
    old: dict[str, str | None] = {"load pressure": None, "conjugate pressure": None}
    old |= {"load gravity": value, "conjugate gravity": conjugate}
    if key in old:
        return old[key]
    energy = re.fullmatch(r"energy (.+) mJ", key)
    if energy is not None:
        return energy_columns([energy[1]])[energy[1]]
    column(key)
    return key


@functools.cache
def column(key: str) -> Column:
    """The column that a row calls so.

    Raises:
        KeyError: there is none.
    """
    for known in COLUMNS:
        if known.names(key):
            return known
    raise KeyError(f"column {key!r} is not in the table of columns")


def is_column(key: str) -> bool:
    """Whether the table has a column of that name."""
    return any(each.names(key) for each in COLUMNS)


def check(keys: Iterable[str], model: Filler) -> None:
    """Refuse keys of a row that the table does not have, or not for a model.

    Raises:
        KeyError: with its name.
    """
    for key in keys:
        if column(key).group not in model.fills:
            raise KeyError(f"column {key!r} is not one of model {model.name}")


def read(model: Filler, scene: Any, state: Any) -> dict[str, float]:
    """Values of the columns that read themselves off a state, for a model."""
    values = {
        known.name: known.read(scene, state)
        for known in COLUMNS
        if known.read is not None and known.group in model.fills
    }
    return {name: value for name, value in values.items() if value is not None}


def table(models: Collection[Filler], beside: bool) -> Iterator[str]:
    """The columns as lines of a Markdown table.

    Args:
        models: every model.
        beside: those of other models beside a run, or the run's own.
    """
    yield "| column | unit | meaning | models |"
    yield "|---|---|---|---|"
    for known in COLUMNS:
        if known.beside == beside:
            fillers = [each.name for each in models if known.group in each.fills]
            names = "all" if len(fillers) == len(models) else ", ".join(fillers)
            yield f"| `{known.name}` | {known.unit} | {known.meaning} | {names} |"
