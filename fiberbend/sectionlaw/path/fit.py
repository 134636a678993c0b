"""Polynomials about the free states of a section, fitted to states about them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fiberbend.sectionlaw.path.chart import PathChart
from fiberbend.sectionlaw.path.curve import Curve, rows
from fiberbend.sectionlaw.path.law import PathLaw
from fiberbend.sectionlaw.path.states import About, graded
from fiberbend.sectionlaw.path.terms import VARIABLES, Kept, terms
from rod.functions import Floats
from rod.spline import Axis

DEGREE = 5
"""Of the splines by the pressure."""
_SINGULAR = 1e-12


def unknowns(degree: int, intervals: int, kept: Kept) -> int:
    """Coefficients of a law."""
    return len(terms(degree, kept).weights) * (intervals + DEGREE)


def fitted(
    chart: PathChart,
    kept: Kept,
    degree: int,
    intervals: int,
    high: float,
    samples: Sequence[About],
) -> PathLaw:
    """The law nearest to energies, forces, areas and stiffnesses of states, by least squares.

    Derivatives count by the usual stiffness against their own coordinate, so that the strains count
    that an error makes, and units do not matter.

    Args:
        chart: coordinates u.
        kept: symmetries.
        degree: of the polynomials in u.
        intervals: of the splines by the pressure.
        high: greatest pressure, MPa.
        samples: states.
    """
    axis, found = Axis(graded(high, intervals), DEGREE), terms(degree, kept)
    u = np.array([each.point[:4] for each in samples])
    by_u, by_p = found.rows(u), rows(axis, np.array([each.point[4] for each in samples]))
    slopes = np.array([each.slopes for each in samples])
    second = np.array([each.second for each in samples])
    stiff = np.median(np.diagonal(second, axis1=1, axis2=2)[:, :4], axis=0)
    unit = float(np.sqrt(stiff.min()))
    weight = unit / np.sqrt(stiff)
    blocks = [_product(by_p[0], by_u[0])]
    aims = [np.array([each.state.energy for each in samples])]

    def add(order: int, polynomials: Floats, aim: Floats, factor: float) -> None:
        blocks.append(factor * _product(by_p[order], polynomials))
        aims.append(factor * aim)

    for order in (1, 2):
        aim = slopes[:, 4] if order == 1 else second[:, 4, 4]
        add(order, by_u[0], aim, high**order)
    for i in range(VARIABLES):
        add(0, by_u[1][i], slopes[:, i], weight[i])
        add(1, by_u[1][i], second[:, i, 4], weight[i] * high)
        for j in range(i, VARIABLES):
            add(0, by_u[2][i, j], second[:, i, j], weight[i] * weight[j])
    matrix = np.concatenate(blocks)
    lengths = np.sqrt(np.sum(matrix**2, axis=0))
    lengths[lengths == 0] = 1.0
    best, *_ = np.linalg.lstsq(matrix / lengths, np.concatenate(aims), rcond=_SINGULAR)
    by_spline = (best / lengths).reshape(axis.count, -1)
    curve = Curve(axis.lines, DEGREE, by_spline @ found.weights)
    return PathLaw(chart, degree, curve, kept.alike)


def _product(splines: Floats, polynomials: Floats) -> Floats:
    """Splines times polynomials at each state, (n, splines × polynomials)."""
    found: Floats = (splines[:, :, None] * polynomials[:, None, :]).reshape(len(splines), -1)
    return found


def errors(law: PathLaw, samples: Sequence[About], ranges: Floats, area: float) -> Floats:
    """Greatest error of N, moments and torque, and of the area, (5,).

    Args:
        law: by its polynomials.
        samples: states that are not fitted.
        ranges: of the strains, (4,): an error of a force is as large as the strain that it makes.
        area: range of the area of the chamber, mm².
    """
    worst = np.zeros(5)
    for each in samples:
        at = each.state.at
        off = np.abs(law.first(at[None, :4], float(at[4]))[0] - each.state.slopes)
        stiff = np.append(np.diag(each.state.second)[:4] * ranges, area)
        worst = np.maximum(worst, off / stiff)
    return worst
