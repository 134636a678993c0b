"""What the errors of a fit do to the pressure at a bending angle."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.materials import MaterialSpec
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Wanted
from materials.stretches import Floats

if TYPE_CHECKING:
    from materials.fit.fit import Fit
    from materials.material import Material

_COUNT = 4
"""Angles where a case names none: as many parts of its greatest one."""
_PART = 0.5
"""Of a standard error by which parameters are moved; less, as long as a law refuses them."""


@dataclasses.dataclass(frozen=True, eq=False)
class Band:
    """The pressure at angles with the errors of a fit.

    Attributes:
        law: name of the law.
        part: the part that is made of the rubber.
        angles: rad, (n,).
        pressure: MPa, (n,).
        error: its standard error, MPa, (n,).
        stretch: greatest stretch of the actuator's rubber at each angle, (n,).
        refits: pressures of refits to resampled tests, MPa, (m, n).
    """

    law: str
    part: str
    angles: Floats
    pressure: Floats
    error: Floats
    stretch: Floats
    refits: Floats

    @property
    def covered(self) -> float:
        """Part of the refits' pressures that lie within the band of 95 %; NaN without refits."""
        inside = np.abs(self.refits - self.pressure) <= 1.96 * self.error
        return float(inside.mean()) if inside.size else float("nan")


def band_of(case: Case, part: str, fit: Fit, refits: int = 0, seed: int = 0) -> Band:
    """Solve a case with the numbers of a fit and with numbers that are moved by their errors.

    The pressure is taken as linear in the parameters within their errors: with the columns v of a
    square root of their covariance its variance is Σ ((P(c + h v) − P(c − h v))/2h)².

    Args:
        case: of model section or cell.
        part: whose material it is, such as "wall".
        fit: the law.
        refits: refits to resampled tests that are solved too.
        seed: of their residuals.

    Raises:
        CaseError: the case has no such part, is none of uniform bending, or cannot be solved.
    """
    angles = _angles(case, part, fit)
    pressure, stretch = pressures(case, part, fit.material, angles)
    size = np.sqrt(np.diag(fit.covariance))
    size[size == 0] = 1.0
    values, ways = np.linalg.eigh(fit.covariance / np.outer(size, size))
    total = np.zeros(len(angles))
    for value, way in zip(values, ways.T, strict=True):
        if value > 1e-9 * values.max():
            total += _slope(case, part, fit, angles, np.sqrt(value) * way * size) ** 2
    source = np.random.default_rng(seed)
    drawn = [
        pressures(case, part, fit.with_values(fit.resampled(source)), angles)[0]
        for _ in range(refits)
    ]
    again = np.array(drawn).reshape(-1, len(angles))
    return Band(fit.form.name, part, angles, pressure, np.sqrt(total), stretch, again)


def pressures(case: Case, part: str, rubber: Material, angles: Floats) -> tuple[Floats, Floats]:
    """Pressures in MPa at angles, and the greatest stretches, where a part is made of a rubber.

    Raises:
        CaseError: the case cannot be solved.
    """
    answer = solve(made_of(case, part, rubber), Wanted(angles=tuple(float(a) for a in angles)))
    if not answer.converged:
        raise CaseError([Problem(f"materials.{part}", f"{_numbers(rubber)}: {answer.reason}")])
    rows = [(point.pressure, np.exp(point.strain)) for point in answer.free]
    pressure, stretch = np.array(rows).T
    return pressure, stretch


def made_of(case: Case, part: str, rubber: Material) -> Case:
    """The case with another law in one part, whose density and bulk modulus stay.

    Raises:
        CaseError: the case has no such part.
    """
    there = [name for name, spec in case.materials if spec is not None]
    if part not in there:
        raise CaseError([Problem("--part", f"{part!r}, expected one of {', '.join(there)}")])
    old = convert.material(getattr(case.materials, part))
    from materials.laws.table import LAWS

    units = {p.name: p.unit for p in LAWS[rubber.law].parameters}
    data: dict[str, object] = {"law": rubber.law}
    for name, value in rubber.parameters.items():
        data[name] = f"{value!r} MPa" if units[name] == "MPa" else value
    if old.density is not None:
        data["density"] = f"{old.density!r} kg/m^3"
    if old.bulk is not None:
        data["bulk"] = f"{old.bulk!r} MPa"
    made = case.materials.model_copy(update={part: MaterialSpec.model_validate(data)})
    return case.model_copy(update={"materials": made})


def _angles(case: Case, part: str, fit: Fit) -> Floats:
    """Those that the case asks for, or parts of the one to which its load bends it."""
    asked = case.output.at_angles
    if asked:
        return np.array(sorted(asked, key=abs))
    load = next((e.inflation() for e in case.effects if e.inflation() is not None), None)
    if load is not None and load.angle is not None:
        most = load.angle
    elif load is not None and load.to is not None:
        answer = solve(made_of(case, part, fit.material), Wanted(pressures=(load.to,)))
        if not answer.converged:
            raise CaseError([Problem("effects", answer.reason)])
        most = answer.free[-1].angle
    else:
        raise CaseError([Problem("output.at_angles", "none, expected angles such as 90 deg")])
    return most * np.arange(1, _COUNT + 1) / _COUNT


def _slope(case: Case, part: str, fit: Fit, angles: Floats, way: Floats) -> Floats:
    """Change of the pressure along one standard error, MPa."""
    step = _PART
    while step > 1e-4:
        try:
            up, down = (fit.with_values(fit.values + sign * step * way) for sign in (1, -1))
            high, low = (pressures(case, part, rubber, angles)[0] for rubber in (up, down))
        except (ValueError, CaseError):
            # a law that refuses such numbers, or gives way with them
            step /= 4
            continue
        return (high - low) / (2 * step)
    raise CaseError(
        [Problem(f"materials.{part}", f"{fit.form.name} cannot be moved by its errors")]
    )


def _numbers(rubber: Material) -> str:
    return ", ".join(f"{name} {value:.4g}" for name, value in rubber.parameters.items())
