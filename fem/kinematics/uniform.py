"""Uniform bending: what is modelled, a section or a slice, is like all others along the axis.

Positions are components x' = (X + u, Y + v, w) in a frame that turns with the section at the rate
ω = (k_x, k_y, τ) and moves along its own z at the rate λ0. Then

    F = ∇x' + (λ0 e_z + ω × x') ⊗ e_z,

exact for a prismatic body that bends and twists uniformly. Which of these are unknowns follows
from symmetry: with a mirror plane z = 0 there is neither τ nor w of a section; with a mirror plane
x = 0, or where half a turn about y maps the body onto itself, no k_y.

Another origin d and other axes Q of the frame, x' → Q x' + d, ω → Q ω, are the same state, as long
as the origin moves along its own e3. Four such motions are left: three shifts, which may tilt the
frame, and a turn about e3. Pins take those away that symmetry leaves: v = 0 at the pin, so that λ0
is the stretch there (without it v + c and λ0 − k_x c would be the same state); with the whole
section u = 0 at pin and crown; where it warps freely w = 0 at the pin.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import ufl

from analytic.path import CentreLine, centre_line
from fem.kinematics.centroid import SectionFit
from fem.kinematics.domain import Domain
from fem.kinematics.kinematics import Carry, Kinematics

Floats = npt.NDArray[np.float64]

CURVATURE, STRETCH, SIDE, TWIST = "curvature", "stretch", "side_curvature", "twist"
AXES = {CURVATURE: 0, SIDE: 1, TWIST: 2}
"""Components of ω: about the section's own x, its y, and the axis."""
_STEP = 1e-30
"""Of complex differentiation: nothing is subtracted (Squire and Trapp 1998,
doi 10.1137/S003614459631241X)."""


class Uniform(Kinematics):
    """What section and cell share.

    Args:
        domain: the mesh.
        fields: names of the fields that the effects ask for.
        length: length L of the actuator between its caps, mm.
        twisted: the winding may twist the body: τ, and w of a section, are unknowns.
        sideways: the body may bend to the side: k_y is an unknown.
        components: number of displacement components.
        extent: length along z of what is modelled, mm.
        drifts: no symmetry keeps what is modelled from a shift along z.

    Attributes:
        length: L, mm.
        extent: length along z of what is modelled, mm.
        twisted: τ is an unknown.
        sideways: k_y is an unknown.

    Raises:
        ValueError: half a section that is to bend to the side.
    """

    def __init__(
        self,
        domain: Domain,
        fields: Iterable[str],
        length: float,
        twisted: bool,
        sideways: bool,
        components: int,
        extent: float,
        drifts: bool,
    ) -> None:
        if sideways and domain.data.half:
            raise ValueError("half a section does not bend to the side")
        super().__init__(domain, fields, components)
        self.length, self.extent = length, extent
        self.twisted, self.sideways = twisted, sideways
        self.symmetry_factor *= length / extent
        wanted = {SIDE: sideways, TWIST: twisted}
        self.natural = (CURVATURE, STRETCH, *(name for name, free in wanted.items() if free))
        pin, crown = (domain.data.points[name] for name in ("pin", "crown"))
        self.pins = ((pin, 1),)
        if not domain.data.half:
            self.pins += ((pin, 0), (crown, 0))
        if drifts:
            self.pins += ((pin, 2),)
        # they may shift along x and z and turn about z
        self.opposite_pins = ((pin, 0), (crown, 0), *(((pin, 2),) if components > 2 else ()))
        for name in self.natural:
            self.scalar(name)
        self.scalars[STRETCH].value = 1.0

    def _spin(self) -> Any:
        """ω as a UFL vector."""
        zero = ufl.constantvalue.Zero()
        return ufl.as_vector([self.scalar(name) if name in self.natural else zero for name in AXES])

    def _relative(self) -> tuple[Any, Any]:
        """x' and its gradient, 3×3."""
        raise NotImplementedError

    @property
    def x(self) -> Any:
        """Position in the turning frame, a UFL vector in mm."""
        return self._relative()[0]

    @property
    def F(self) -> Any:
        """Deformation gradient, a UFL 3×3 tensor, its rows in the turning frame."""
        x, gradient = self._relative()
        column = ufl.cross(self._spin(), x)
        zero = ufl.constantvalue.Zero()
        stretch = self.scalar(STRETCH)
        along = [column[0], column[1], stretch + column[2]]
        return gradient + ufl.as_matrix([[zero, zero, entry] for entry in along])

    def volume_density(self, surface: str) -> Any:
        """Density per reference area of the volume that a closed cavity surface encloses.

        With g = λ0 e_z + ω × x', J = det ∇x' + (x'_X × x'_Y) · g. The first part is the divergence
        of x'_1 times a row of the cofactor; g has no divergence and is the curl of
        A = λ0 x'_1 e_2 − ω |x'|²/2, so the second part is A along the wall's trace in the section.
        N points out of the solid. Mirror planes and periodic ends add nothing.
        """
        x, gradient = self._relative()
        normal = ufl.FacetNormal(self.domain.mesh)
        along = ufl.dot(gradient, ufl.as_vector([-normal[1], normal[0], 0]))
        square = ufl.dot(x, x) / 2
        trace = self.scalar(STRETCH) * x[0] * along[1] - self.scalar(CURVATURE) * square * along[0]
        if self.sideways:
            trace -= self.scalar(SIDE) * square * along[1]
        if self.twisted:
            trace -= self.scalar(TWIST) * square * along[2]
        return -trace - self._bulge(x, gradient, normal)

    def _bulge(self, x: Any, gradient: Any, normal: Any) -> Any:
        """Flux of the first part; nothing where nothing depends on z."""
        return ufl.constantvalue.Zero()

    def size_of(self, scalar: str) -> float:
        """A change of a natural scalar that strains like a stretch of one."""
        height = float(self.domain.data.extent[:2].max())
        return {STRETCH: 1.0}.get(scalar, 1 / height)

    def spin(self, scalars: Mapping[str, float]) -> Floats:
        """ω by values of the natural scalars, (3,); what is none of them is zero."""
        return np.array([scalars[name] if name in self.natural else 0.0 for name in AXES])

    def moved(self) -> None:
        """Centroid and axes are those of the section as it is now."""
        self.__dict__.pop("fit", None)

    def resize(self, length: float) -> None:
        """Stand for another length L of the actuator, mm."""
        self.symmetry_factor *= length / self.length
        self.length = length

    def carry(self) -> Carry:
        """Stretch and spin at the present state."""
        values = {name: float(self.scalars[name].value) for name in self.natural}
        axes = np.eye(3)
        rates = {STRETCH: (axes[2], np.zeros(3))}
        for name, axis in AXES.items():
            if name in values:
                rates[name] = (np.zeros(3), axes[axis])
        return Carry(values[STRETCH], self.spin(values), rates)

    def turned(self) -> float | None:
        """L |ω|, where the body bends to the side as well: its angle may be none."""
        return float(np.linalg.norm(self.carry().spin)) * self.length if self.sideways else None

    @functools.cached_property
    def fit(self) -> SectionFit:
        """Centroid and axes of what lies inside the winding."""
        return SectionFit(self)

    def centre_line(self) -> CentreLine:
        """The centroids' line at the present state; collective."""
        carry = self.carry()
        fit = self.fit.read(self.w.x.array[: self.owned])
        return CentreLine.of(carry.spin, carry.stretch, *fit, turned=self.sideways)


class CurvatureAngle:
    """θ = L b·d1, the turn of the centre-line's tangent about the section's own lateral axis.

    Bent in its plane, a body has one curvature k at every height and θ = k L. Under twist the
    lines of a section are helices of different curvature, and θ is that of the centroids' line.
    Where the body bends to the side, the section may turn in its frame, and d1 turns with it.

    Args:
        body: kinematics of uniform bending.
    """

    def __init__(self, body: Uniform) -> None:
        self._body = body
        self._plane = not body.twisted and not body.sideways

    def value(self) -> float:
        """At the present state, rad."""
        body = self._body
        if self._plane:
            return float(body.scalars[CURVATURE].value) * body.length
        return float(body.centre_line().rates[0]) * body.length

    def row(self) -> Floats:
        """∂θ/∂w on the owned dofs, rad/mm: by the centroid and, where they are free, the axes."""
        body = self._body
        if self._plane:
            return np.zeros(body.owned)
        slopes = np.zeros((3, 3))
        for place in np.ndindex(3 if body.sideways else 1, 3):
            slopes[place] = self._slope(fit=place)
        return body.fit.row(slopes)

    def slope(self, scalar: str) -> float:
        """∂θ/∂q of a global scalar."""
        body = self._body
        if self._plane:
            return body.length if scalar == CURVATURE else 0.0
        return self._slope(scalar=scalar) if scalar in body.natural else 0.0

    def _slope(self, scalar: str = "", fit: tuple[int, ...] | None = None) -> float:
        """Derivative by a scalar or by a component of centroid or axes, by a complex step."""
        body = self._body
        carry = body.carry()
        spin, stretch = carry.spin.astype(complex), complex(carry.stretch)
        read = body.fit.read(body.w.x.array[: body.owned])
        section = np.array(read, dtype=complex)
        if fit is not None:
            section[fit] += 1j * _STEP
        elif scalar == STRETCH:
            stretch += 1j * _STEP
        else:
            spin[AXES[scalar]] += 1j * _STEP
        across = (section[1], section[2]) if body.sideways else None
        rates: Any = centre_line(spin, stretch, section[0], across)[1]
        return float(rates[0].imag) / _STEP * self._body.length
