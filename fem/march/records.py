"""What a march is told, what it remembers and what it reports."""

from __future__ import annotations

import dataclasses
from typing import Protocol

import numpy as np
import numpy.typing as npt

from fem.march.frames import Shape
from fem.solver.newton import Outcome

Floats = npt.NDArray[np.float64]


DRIVES = ("value", "conjugate", "control")
"""What a ramp may drive."""
MODES = "modes"
TURN = "turn"
"""Measure of all that a body turns, where its bending angle is a part of that."""
"""Name of the measure that counts unstable modes."""


@dataclasses.dataclass
class State:
    """A converged state, this rank's part.

    Attributes:
        w: owned coefficients of the fields, (owned,).
        scalars: values of the global scalars.
        measures: values that ramps and requests refer to, by name.
        shape: rod description of the displacement; None where the kinematics turns by itself.
        discrete: memory of the discrete potentials, by effect.
    """

    w: Floats
    scalars: dict[str, float]
    measures: dict[str, float]
    shape: Shape | None
    discrete: dict[str, dict[str, Floats]]


@dataclasses.dataclass(frozen=True)
class Ramp:
    """One load: a scalar driven to a target, directly or through its work-conjugate.

    The work-conjugate of a scalar q is −∂Π/∂q: the chamber volume in mm³ of a pressure in MPa. The
    control quantity of a march is a functional of the state, the bending angle in rad.

    Attributes:
        scalar: name of the global scalar, such as 'pressure'.
        target: its final value, or its conjugate's (the chamber volume).
        drive: 'value'; 'conjugate' to find the scalar so that its conjugate follows the ramp; or
            'control' to find it so that the control quantity does.
        first: first increment of the driven quantity; None: from the linear response.
        largest: greatest increment; None: no limit but the convergence.
        stops: values of the driven quantity to be hit exactly.
        at: values of the control quantity to be hit exactly wherever they are crossed.
        until: value of the control quantity at which the run ends where it is crossed, up or down;
            None: at the target.
        conjugated: its work-conjugate tells and leads where the load has a greatest value; that
            of a given deformation, or of a load without a potential, does not.
    """

    scalar: str
    target: float
    drive: str = "value"
    first: float | None = None
    largest: float | None = None
    stops: tuple[float, ...] = ()
    at: tuple[float, ...] = ()
    until: float | None = None
    conjugated: bool = True

    def __post_init__(self) -> None:
        if self.drive not in DRIVES:
            raise ValueError(f"drive {self.drive!r}, expected one of {', '.join(DRIVES)}")

    @property
    def key(self) -> str:
        """Name of the measure that it drives."""
        return measure(self.drive, self.scalar)


def measure(kind: str, scalar: str) -> str:
    """Name of what is driven: 'control', or the value or the conjugate of a scalar."""
    return kind if kind == "control" else f"{kind} {scalar}"


@dataclasses.dataclass(frozen=True)
class Rules:
    """Incrementation as in Abaqus and CalculiX.

    Attributes:
        easy: iterations up to which the next increment grows by `grow`.
        slow: iterations from which it shrinks by `shrink`.
        cut: factor after a failed increment.
        cutbacks: consecutive failed increments after which the march gives up; on a falling
            branch beyond a limit point, which only explains why a load is not reached, all of them.
        turn: greatest change of the control quantity an increment may aim at.
        first_turn: the same for an increment from the linear response.
        memory: states from which the next is extrapolated: 3 on a smooth path, more where steps are
            short; 2 where kinks are to be expected, across which a parabola misleads and foresees
            limit points.
        least: least increment after a failure, relative to the whole ramp; after slow convergence
            also to the ramp's first.
        jump: how much further, in units of the step that was expected, the conjugate may go in an
            increment of the value; beyond it Newton may have found another branch.
        swell: greatest relative change of the conjugate in an increment that drives it in place
            of the value.
        beyond: how far beyond a limit point a falling branch is traced, as a factor of the
            conjugate.
        search: multiple of the conjugate at rest up to which a control quantity that the load
            hardly moves is looked for; the other way it ends at one over `beyond`.
        astray: how far it may move the other way meanwhile.
    """

    easy: int = 5
    grow: float = 1.5
    slow: int = 8
    shrink: float = 0.6
    cut: float = 0.25
    cutbacks: int = 6
    turn: float = np.deg2rad(60.0)
    first_turn: float = np.deg2rad(20.0)
    memory: int = 3
    least: float = 1e-5
    jump: float = 2.0
    swell: float = 0.3
    beyond: float = 4.0
    search: float = 20.0
    astray: float = np.pi


@dataclasses.dataclass(frozen=True)
class Critical:
    """Where a body loses its stability, or gains it back, with all loads at given values.

    Attributes:
        kind: 'limit': a load that is driven has a greatest or a least value here, and the mode is
            gone where its conjugate is given instead; 'bifurcation': another branch starts here,
            and the mode is there however the load is driven.
        scalar: the load that is driven.
        value: its value there, interpolated.
        conjugate: its conjugate there, such as the chamber volume.
        control: the control quantity there, if there is one.
        before: unstable modes before it.
        after: unstable modes beyond it.
        side: of a bifurcation whose other branch was taken, what chose its side: 'by the loads',
            or 'chosen' where both are alike; empty where the path was not left, and of a rod 'not
            looked for'.
        wrinkle: of a bifurcation, the mode's waves span less than three elements.
    """

    kind: str
    scalar: str
    value: float
    conjugate: float
    control: float | None
    before: int
    after: int
    side: str = ""
    wrinkle: bool = False


@dataclasses.dataclass
class Report:
    """How a march ended.

    Attributes:
        status: 'converged'; 'stopped' where the load cannot be reached; or 'failed'.
        reason: why not converged, or empty.
        steps: converged increments.
        iterations: Newton iterations, failed increments included.
        factorisations: tangents factorised for them.
        cutbacks: failed increments.
        per_step: iterations of each converged increment.
        critical: where stability was lost or gained, in the order of the march.
        self_contact: measures where the body begins to pass through itself; None: it does not.
        hits: number of the converged increment and value of the control quantity, for each value
            that was asked for and hit.
        ended_at: value of the control quantity at which the run was to end early, and did.
    """

    status: str = "converged"
    reason: str = ""
    steps: int = 0
    iterations: int = 0
    factorisations: int = 0
    cutbacks: int = 0
    per_step: list[int] = dataclasses.field(default_factory=list)
    critical: list[Critical] = dataclasses.field(default_factory=list)
    self_contact: dict[str, float] | None = None
    hits: list[tuple[int, float]] = dataclasses.field(default_factory=list)
    ended_at: float | None = None

    def __post_init__(self) -> None:
        # a checkpoint gives back mappings
        self.critical = [c if isinstance(c, Critical) else Critical(**c) for c in self.critical]
        self.hits = [(int(step), float(value)) for step, value in self.hits]

    def count(self, outcome: Outcome) -> None:
        """Add what a solve has cost."""
        self.iterations += outcome.iterations
        self.factorisations += outcome.factorisations


class Causes(Protocol):
    """Tells what fails physically; it knows the effects, the march does not."""

    def inverted(self) -> str:
        """Where an element is turned inside out at the present iterate; empty where none is."""

    def explain(
        self,
        states: list[State],
        rest: State,
        critical: list[Critical],
        outcome: Outcome,
        inverted: str,
    ) -> str:
        """The reason of a failure in words; collective."""
