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
_LINEAR, _BY_PRESSURE = 2, 3
"""Forces and stiffnesses of the free states, terms of no higher degree in u, follow the pressure
by splines; the terms beyond by polynomials of this degree, which few states determine."""
_SINGULAR = 1e-12


def unknowns(degree: int, intervals: int, kept: Kept) -> int:
    """Coefficients of a law."""
    orders = terms(degree, kept).orders
    low = int(np.sum(orders <= _LINEAR))
    return low * (intervals + DEGREE) + (len(orders) - low) * (1 + _BY_PRESSURE)


def fitted(
    chart: PathChart,
    kept: Kept,
    degree: int,
    intervals: int,
    high: float,
    samples: Sequence[About],
    ranges: Floats,
    area: float,
) -> PathLaw:
    """The law nearest to energies, forces, areas and stiffnesses of states, by least squares.

    A force counts as `errors` has it, by the strain that its error makes; a second derivative by
    what it makes of both of its forces over the box.

    Args:
        chart: coordinates u.
        kept: symmetries.
        degree: of the polynomials in u.
        intervals: of the splines by the pressure.
        high: greatest pressure, MPa.
        samples: states.
        ranges: of the strains, (4,).
        area: range of the area of the chamber, mm².
    """
    axis, found = Axis(graded(high, intervals), DEGREE), terms(degree, kept)
    u = np.array([each.point[:4] for each in samples])
    pressures = np.array([each.point[4] for each in samples])
    by_u, by_p = found.rows(u), rows(axis, pressures)
    low, beyond = found.orders <= _LINEAR, _polynomials(pressures / high) / high**_ORDERS
    slopes = np.array([each.slopes for each in samples])
    second = np.array([each.second for each in samples])
    stiff = np.median(np.diagonal(second, axis1=1, axis2=2)[:, :4], axis=0)
    # of errors of ∂Φ/∂u and of ∂Φ/∂(P over the greatest)
    weight = np.append(np.abs(chart.sizes) / (stiff * ranges), 1 / (area * high))
    blocks, aims = list[Floats](), list[Floats]()

    def add(order: int, polynomials: Floats, aim: Floats, factor: float) -> None:
        factor *= high**order
        both = [_product(by_p[order], polynomials[:, low])]
        both.append(_product(beyond[order], polynomials[:, ~low]))
        blocks.append(factor * np.concatenate(both, axis=1))
        aims.append(factor * aim)

    add(0, by_u[0], np.array([each.state.energy for each in samples]), weight[4])
    add(1, by_u[0], slopes[:, 4], weight[4])
    add(2, by_u[0], second[:, 4, 4], weight[4])
    for i in range(VARIABLES):
        add(0, by_u[1][i], slopes[:, i], weight[i])
        add(1, by_u[1][i], second[:, i, 4], np.sqrt(weight[i] * weight[4]))
        for j in range(i, VARIABLES):
            add(0, by_u[2][i, j], second[:, i, j], np.sqrt(weight[i] * weight[j]))
    matrix = np.concatenate(blocks)
    lengths = np.sqrt(np.sum(matrix**2, axis=0))
    lengths[lengths == 0] = 1.0
    best, *_ = np.linalg.lstsq(matrix / lengths, np.concatenate(aims), rcond=_SINGULAR)
    best = best / lengths
    by_spline, count = np.empty((axis.count, len(low))), axis.count * int(low.sum())
    by_spline[:, low] = best[:count].reshape(axis.count, -1)
    by_spline[:, ~low] = _as_splines(axis) @ best[count:].reshape(1 + _BY_PRESSURE, -1)
    curve = Curve(axis.lines, DEGREE, by_spline @ found.weights)
    return PathLaw(chart, degree, curve, kept.alike)


_ORDERS = np.arange(3.0)[:, None, None]


def _polynomials(parts: Floats) -> Floats:
    """Powers of P over the greatest with two derivatives by it, (3, n, powers)."""
    j = np.arange(1 + _BY_PRESSURE)
    t = parts[:, None]
    rates = (t**j, j * t ** np.maximum(j - 1, 0), j * (j - 1) * t ** np.maximum(j - 2, 0))
    return np.array(rates)


def _as_splines(axis: Axis) -> Floats:
    """Coefficients of splines that are the powers of P over the greatest, exactly."""
    places = np.linspace(0.0, 1.0, 4 * axis.count)
    known = rows(axis, places * axis.lines[-1])[0]
    found, *_ = np.linalg.lstsq(known, _polynomials(places)[0], rcond=None)
    return np.asarray(found)


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
