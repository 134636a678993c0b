"""Smeared fibers that sink into the rubber under them and slip along it."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from fem.effects.effect import Natural
from fem.effects.embedded_fibers import FiberPotential
from fem.effects.mean_stretch import MeanStretch, Second
from fem.kinematics.kinematics import Kinematics
from geometry.winding.segments import Lines, SmearedFibers
from materials.bedding import Bedding

Floats = npt.NDArray[np.float64]

PRESSURE = "pressure"
MODES = 3
"""Sines of the slip around the outline, and cosines where nothing makes it odd. Two more change no
answer of docs/evidence/families.md by more than 0.2 %."""


@dataclasses.dataclass(frozen=True)
class Run:
    """How the fibers of a section run.

    Attributes:
        sine: of the angle between fiber and axis, of every segment, (n,).
        perimeter: of the outline, mm.
    """

    sine: Floats
    perimeter: float


def across(segments: SmearedFibers, sine: Floats) -> Lines:
    """Lines on the surface of a section, across its fibers.

    Args:
        segments: the fibers; for those along the axis, on which nothing hangs, their own lines.
        sine: of their angles with the axis, (n,).
    """
    around = sine > 0
    cosine = np.sqrt(1 - np.minimum(sine, 1.0) ** 2)
    # along the outline a fiber has the part sin α of its length, what is across it cos α
    ratio = np.where(around, cosine / np.where(around, sine, 1.0), 1.0)
    axial = np.where(around, -sine * segments.length, segments.length)
    return dataclasses.replace(
        segments.lines(np.arange(len(sine))),
        tangents=segments.tangents * ratio[:, None, None],
        axial=axial[:, None] * np.ones_like(segments.axial),
    )


class BeddedPotential(FiberPotential):
    """Π = Σ ½ S ℓ e² + ½ k_s Σ ℓ s², e = λ_f − 1 − s', S = EA k/(k + EA κ²).

    The strain of the surface along a fiber is shared by the fiber itself, by the bulge b, which
    takes κ b, and by the slip s: T = EA (λ_f − 1 − κ b − s'), and k b = κ T. With b eliminated
    T = S e. s is a sum of sines around the outline for every family of fibers, whose factors are
    global unknowns; where the whole outline is modelled, of cosines too. By a half turn about the
    crown, which maps every family onto itself, s is odd where half of it is modelled.

    k = k0 exp y, y = a (λ_n − 1) + c p/k0, see `Bedding`; so Π = Σ ℓ U(e, y) with U = ½ S e²:

        ∂S/∂y = EA h m/(m + h)²,   ∂²S/∂y² = EA h m (h − m)/(m + h)³,   h = EA κ²/k0,   m = exp y.

    The pressure does work on the bulge, so that −∂Π/∂p is a part of the chamber's volume.

    Args:
        body: kinematics of a section.
        segments: pieces of fiber.
        stiffness: axial stiffness EA of a whole fiber, N; of several that of every segment, (n,).
        bedding: stiffness of the rubber.
        run: how the fibers run.
    """

    def __init__(
        self,
        body: Kinematics,
        segments: SmearedFibers,
        stiffness: float | Floats,
        bedding: Bedding,
        run: Run,
    ) -> None:
        super().__init__(body, segments, stiffness)
        # an old tangent lacks what the rubber's own stiffness changes
        self.mixed = False
        self._bedding = bedding
        self._whole = self.stiffness
        self._softness = self._whole * segments.curvature[self.index] ** 2 / bedding.normal
        """h."""
        lines = across(segments, run.sine).lines(self.index)
        self._across = MeanStretch(body, lines)
        self._slip = _Slip(segments, run, bool(body.domain.data.half), self.index)
        for name in (PRESSURE, *self._slip.names):
            body.scalar(name)
        self.natural = {name: Natural(0.0, 1.0, True, False) for name in self._slip.names}
        self._predicted_across: Floats | None = None

    # --- state ---------------------------------------------------------------------------------

    def update(self, w: Floats) -> None:
        """Strains, stiffness and its derivatives at local coefficients w and the scalars."""
        super().update(w)
        self._across.update(w)
        bed, soft = self._bedding, self._softness
        self._slips = np.array([self._value(name) for name in self._slip.names])
        self.strain = self.strain - self._slip.slopes @ self._slips
        stretch = self._across.value - 1
        m = np.exp(bed.across * stretch + bed.pressure / bed.normal * self._value(PRESSURE))
        both = m + soft
        self.stiffness = self._whole * m / both
        first = self._whole * soft * m / both**2
        self._along_y: Floats = first * self.strain**2 / 2
        """U_y, N, (n,)."""
        self._mixed_y: Floats = first * self.strain
        self._second_y: Floats = first * (soft - m) / both * self.strain**2 / 2
        slips = zip(self._slip.names, -self._slip.slopes.T, strict=True)
        self._e_by = {**self._along.by_scalar, **dict(slips)}
        self._y_by = {name: bed.across * rate for name, rate in self._across.by_scalar.items()}
        self._y_by[PRESSURE] = np.full(len(self.index), bed.pressure / bed.normal)

    def _value(self, name: str) -> float:
        return float(self._body.scalars[name].value)

    def energy(self) -> float:
        """Of fibers and bulges, and of the slip, N mm."""
        slip = self._slips @ self._slip.mass @ self._slips * self._bedding.along / 2
        return super().energy() + float(slip)

    # --- first derivative ------------------------------------------------------------------------

    def add_residual(self, b: Floats) -> None:
        """Add ∂Π/∂w to local coefficients."""
        super().add_residual(b)
        pull = self.length * self._along_y * self._bedding.across
        self._across.add(b, pull[:, None] * self._across.by_dofs)

    def conjugate(self, name: str) -> float:
        """−∂Π/∂q of a global scalar; zero where it does not enter."""
        found = 0.0
        if name in self._e_by:
            found -= float(np.sum(self.length * self.force * self._e_by[name]))
        if name in self._y_by:
            found -= float(np.sum(self.length * self._along_y * self._y_by[name]))
        if name in self._slip.names:
            row = self._slip.mass[self._slip.names.index(name)]
            found -= float(self._bedding.along * row @ self._slips)
        return found

    # --- second derivative -----------------------------------------------------------------------

    def predict(
        self, correction: Floats | None, scalars: Mapping[str, float] | None = None
    ) -> None:
        """Forces along e and y from the values and gradients at the last tangent; None: present."""
        self._second, self._predicted, self._predicted_across = None, None, None
        if correction is None:
            return
        bed, given = self._bedding, scalars or {}
        strain: Floats = self._along.change(correction, scalars)
        for name, slope in zip(self._slip.names, self._slip.slopes.T, strict=True):
            strain = strain - slope * given.get(name, 0.0)
        y: Floats = bed.across * self._across.change(correction, scalars)
        y = y + bed.pressure / bed.normal * given.get(PRESSURE, 0.0)
        self._predicted = self.stiffness * (self.strain + strain) + self._mixed_y * y
        across: Floats = self._along_y + self._mixed_y * strain + self._second_y * y
        self._predicted_across = across

    def tangent_blocks(self) -> Floats:
        """∂²Π/∂w² of every segment, (n, k, k)."""
        self._across.hold()
        return super().tangent_blocks()

    def _second_derivatives(self) -> Second:
        """∂²Π of every segment in its own dofs and the scalars, at the present state."""
        if self._second is not None:
            return self._second
        along = self.force if self._predicted is None else self._predicted
        by_y = self._along_y if self._predicted_across is None else self._predicted_across
        a, length = self._bedding.across, self.length
        curved = self._along.curved(length * along)
        part = self._across.curved(length * by_y * a)
        e, y = self._along.by_dofs, a * self._across.by_dofs
        ee, ey, yy = length * self.stiffness, length * self._mixed_y, length * self._second_y
        # half of what is symmetric, and its transpose
        sides = (ee / 2)[:, None] * e + ey[:, None] * y
        half = (
            sides[:, :, None] * e[:, None, :]
            + ((yy / 2)[:, None] * y)[:, :, None] * (y[:, None, :])
        )
        block = curved.block + part.block + half + half.swapaxes(1, 2)
        zero = np.zeros(len(length))
        names = dict.fromkeys((*self._e_by, *self._y_by))
        mixed: dict[str, Floats] = {}
        both: dict[tuple[str, str], float] = {}
        for name in names:
            by_e, by_y_too = self._e_by.get(name, zero), self._y_by.get(name, zero)
            pull_e, pull_y = ee * by_e + ey * by_y_too, ey * by_e + yy * by_y_too
            mixed[name] = pull_e[:, None] * e + pull_y[:, None] * y
            for found in (curved, part):
                if name in found.mixed:
                    mixed[name] += found.mixed[name]
            for other in names:
                value = float(pull_e @ self._e_by.get(other, zero))
                value += float(pull_y @ self._y_by.get(other, zero))
                value += sum(found.scalars.get((name, other), 0.0) for found in (curved, part))
                both[name, other] = value
        for row, name in enumerate(self._slip.names):
            for column, other in enumerate(self._slip.names):
                both[name, other] += float(self._bedding.along * self._slip.mass[row, column])
        self._second = Second(block, mixed, both)
        return self._second

    def add_load(self, name: str, b: Floats) -> None:
        """Add ∂²Π/∂w∂q to local coefficients."""
        if name in self._e_by or name in self._y_by:
            self._along.add(b, self._second_derivatives().mixed[name])

    def second_derivative(self, first: str, second: str) -> float:
        """∂²Π/∂q∂r of two global scalars."""
        return self._second_derivatives().scalars.get((first, second), 0.0)

    # --- memory of converged steps ---------------------------------------------------------

    def state(self) -> dict[str, Floats]:
        """Both forces, from which the next step's first tangent is built."""
        return {**super().state(), "across": self._along_y}

    def extrapolate(self, states: list[dict[str, Floats]], weights: Floats) -> None:
        """Predicted forces from a weighted sum of remembered states."""
        super().extrapolate(states, weights)
        kept = np.array([state["across"] for state in states])
        across: Floats = weights @ kept
        self._predicted_across = across


class _Slip:
    """The slip of every family as a sum of waves around the outline.

    Attributes:
        names: of their factors, global scalars in mm.
        slopes: s' of each, by segment, 1/mm, (n, m).
        mass: ∫ s_i s_j over the fibers' length, (m, m), mm.
    """

    def __init__(
        self, segments: SmearedFibers, run: Run, odd: bool, index: npt.NDArray[np.int64]
    ) -> None:
        s, family, length = (
            segments.s[index],
            segments.family[index],
            segments.length[index],
        )
        self.names: list[str] = []
        waves, slopes = [], []
        for number in np.unique(family):
            here = family == number
            if not np.any(run.sine[index][here] > 0):
                continue
            for mode in range(1, MODES + 1):
                wave = 2 * np.pi * mode / run.perimeter
                rise = wave * run.sine[index] * here
                self.names.append(f"slip {number} {mode}")
                waves.append(np.sin(wave * s) * here)
                slopes.append(np.cos(wave * s) * rise)
                if not odd:
                    self.names.append(f"slip {number} -{mode}")
                    waves.append(np.cos(wave * s) * here)
                    slopes.append(-np.sin(wave * s) * rise)
        self.slopes: Floats = np.array(slopes).T
        values = np.array(waves).T
        self.mass: Floats = values.T @ (length[:, None] * values)
