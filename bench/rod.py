"""The rod: which discretisation, what shear and the rule of masses matter, and what a state costs.

Prints the numbers that docs/decisions.md quotes: `.venv/bin/python -m bench.rod`.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_bvp
from scipy.linalg import eigh

from bench.tables import table
from rod.functions import Floats
from rod.inertia import SectionMass, lump, spread
from rod.law import Linear, Zones
from rod.layout import Layout
from rod.loads import TipForce, Weight
from rod.modes import modes
from rod.motion import Motion
from rod.rod import Level, Rod
from rod.statics import Path, march
from rod.table import tabulate
from rod.term import Term

LENGTH, WIDTH, HEIGHT = 120.0, 16.0, 14.0
YOUNG, DENSITY = 1.0, 1.1e-9
"""A solid bar of the size of the baseline, mm, and of rubber, MPa and t/mm³."""
AREA = WIDTH * HEIGHT
BENDING = YOUNG * WIDTH * HEIGHT**3 / 12
SHEAR = YOUNG / 3 * AREA * 5 / 6
AXIAL = YOUNG * AREA
FORCE = 0.6
"""Across the tip, N: it bends the bar by a radian."""
PIECES = (6, 12, 24, 48)
STIFFNESS = {"shear_y": SHEAR, "stretch": AXIAL, "curvature": BENDING}
NO_SHEAR, WITH_SHEAR = ("stretch", "curvature"), ("shear_y", "stretch", "curvature")
WEIGHT = (0.0, -9810.0, 0.0)
STEPS = np.linspace(0.2, 1.0, 5).tolist()


def bar(pieces: int, strains: tuple[str, ...], *tip: Term) -> Rod:
    """The bar, clamped; its first term is its weight."""
    layout = Layout(np.full(pieces, LENGTH / pieces), strains)
    law = Linear(np.diag([STIFFNESS[name] for name in strains]), layout.at_rest()[0])
    second = (DENSITY * HEIGHT * WIDTH**3 / 12, DENSITY * BENDING / YOUNG, 0.0)
    masses = spread(layout, [SectionMass(DENSITY * AREA, second=second)])
    return Rod(layout, law, masses, (Weight(masses, WEIGHT), *tip))


def exact(shear: float) -> Floats:
    """Angle and place (z, −y) of the tip by the rod's differential equations and collocation.

    Args:
        shear: GA, N; infinite: none.
    """

    def slopes(_s: Floats, y: Floats) -> Floats:
        angle, moment = y[0], y[1]
        normal, across = FORCE * np.sin(angle), FORCE * np.cos(angle)
        stretch, slide = 1 + normal / AXIAL, across / shear
        ahead = stretch * np.cos(angle) - slide * np.sin(angle)
        down = stretch * np.sin(angle) + slide * np.cos(angle)
        return np.vstack([moment / BENDING, -FORCE * ahead, ahead, down])

    def ends(root: Floats, tip: Floats) -> Floats:
        return np.array([root[0], root[2], root[3], tip[1]])

    s = np.linspace(0, LENGTH, 201)
    guess = np.vstack([s / LENGTH, 0 * s, s, 0 * s])
    found = solve_bvp(slopes, ends, s, guess, tol=1e-11, max_nodes=100_000)
    out: Floats = found.y[[0, 2, 3], -1]
    return out


def nodal(pieces: int, shear: float) -> tuple[Floats, int]:
    """The same by nodes (Simo and Vu-Quoc 1986, doi 10.1016/0045-7825(86)90079-4).

    Two-node elements with linear places and angles and one point of integration.

    Args:
        pieces: elements.
        shear: GA, N.

    Returns:
        Angle and place of the tip, and the iterations of all five load steps.
    """
    h = LENGTH / pieces
    z = h * np.arange(pieces + 1)
    x = np.stack([z, 0 * z, 0 * z], axis=1).ravel()
    iterations = 0
    stiffness = np.array([AXIAL, shear, BENDING])
    for share in STEPS:
        for _ in range(60):
            force, matrix = np.zeros_like(x), np.zeros((len(x), len(x)))
            force[-2] = -share * FORCE
            for piece in range(pieces):
                place = slice(3 * piece, 3 * piece + 6)
                (z0, d0, a0), (z1, d1, a1) = x[place].reshape(2, 3)
                cos, sin = math.cos((a0 + a1) / 2), math.sin((a0 + a1) / 2)
                along, down = (z1 - z0) / h, (d1 - d0) / h
                stretch, slide = along * cos + down * sin, down * cos - along * sin
                strain = np.array([stretch - 1, slide, (a1 - a0) / h])
                rows = np.array(
                    [
                        [-cos / h, -sin / h, slide / 2, cos / h, sin / h, slide / 2],
                        [sin / h, -cos / h, -stretch / 2, -sin / h, cos / h, -stretch / 2],
                        [0, 0, -1 / h, 0, 0, 1 / h],
                    ]
                )
                stress = stiffness * strain
                force[place] += h * rows.T @ stress
                block = rows.T @ (stiffness[:, None] * rows)
                # second derivatives of stretch and slide by the mean angle
                turn = np.array([0, 0, 0.5, 0, 0, 0.5])
                more = np.outer(turn, stress[0] * rows[1] - stress[1] * rows[0])
                more = more + more.T
                more += np.outer(turn, turn) * (stress[0] * stretch + stress[1] * slide)
                block += more
                matrix[place, place] += h * block
            step = np.zeros_like(x)
            step[3:] = np.linalg.solve(matrix[3:, 3:], force[3:])
            x = x - step
            iterations += 1
            if np.abs(step).max() < 1e-9:
                break
    return np.array([x[-1], x[-3], x[-2]]), iterations


def discretisations() -> str:
    """Errors of angle and place of the tip, unknowns and iterations."""
    rows = []
    for pieces in PIECES:
        for name, strains in (("screws", NO_SHEAR), ("screws with shear", WITH_SHEAR)):
            aim = exact(math.inf if strains is NO_SHEAR else SHEAR)
            rod = bar(pieces, strains, TipForce((0.0, -FORCE, 0.0)))
            path = Path(Level(), Level(amounts=(0.0, 1.0)))
            states = march(rod, rod.layout.at_rest(), path, STEPS)
            angle = float(np.sum(rod.layout.weights("curvature") * states[-1].strains))
            tip = states[-1].shape.places[-1]
            found = np.array([angle, tip[2], -tip[1]])
            count = sum(state.iterations for state in states)
            rows.append([name, pieces, rod.layout.at_rest().size, *_errors(found, aim), count])
        for name, shear in (("nodes with shear", SHEAR), ("nodes, shear × 10⁴", 1e4 * SHEAR)):
            found, count = nodal(pieces, shear)
            rows.append([name, pieces, 3 * pieces, *_errors(found, exact(shear)), count])
    head = ["discretisation", "pieces", "unknowns", "angle", "tip/L", "iterations"]
    return "\n".join(table(head, rows))


def _errors(found: Floats, aim: Floats) -> list[str]:
    away = float(np.linalg.norm(found[1:] - aim[1:])) / LENGTH
    return [f"{found[0] / aim[0] - 1:.1e}", f"{away:.1e}"]


def shear_share() -> str:
    """What the shear of the section does under loads on the tip, in a bar with stiff caps."""
    rows = []
    for name, force, mass in (("0.2 N", 0.2, 0.0), ("0.6 N", FORCE, 0.0), ("20 g", 0.0, 2e-5)):
        found = []
        for strains in (NO_SHEAR, WITH_SHEAR):
            plain = bar(48, strains, TipForce((0.0, -force, 0.0)))
            law = plain.law
            assert isinstance(law, Linear)
            cap = dataclasses.replace(law, stiffness=100 * law.stiffness)
            caps = Zones((law, cap), [1, 1, *([0] * 44), 1, 1])
            masses = plain.inertia.copy()
            masses[-1] += lump(mass, (0.0, 0.0, 0.0))
            rod = Rod(plain.layout, caps, masses, (Weight(masses, WEIGHT), *plain.terms[1:]))
            path = Path(Level(), Level(amounts=(1.0 if mass else 0.0, 1.0)))
            found.append(march(rod, rod.layout.at_rest(), path, STEPS)[-1])
        angles, tips = zip(
            *((float(np.sum(s.shape.layout.weights("curvature") * s.strains)),
               s.shape.places[-1]) for s in found),
            strict=True,
        )  # fmt: skip
        away = float(np.linalg.norm(tips[1] - tips[0]))
        change = f"{angles[1] / angles[0] - 1:+.2%}"
        rows.append([name, f"{math.degrees(angles[0]):.2f}°", change, f"{away:.2f} mm"])
    return "\n".join(table(["load", "angle without shear", "with shear", "tip"], rows))


def rules_of_mass() -> str:
    """Third frequency by halves at the ends of pieces, and by Simpson's rule, beside a fine rod's.

    For Simpson's each piece is two, which are held to be alike, with masses of 1/6, 2/3 and 1/6.
    """
    rows = []
    aim = _third(bar(384, ("curvature",)))
    for pieces in PIECES:
        rod, fine = bar(pieces, ("curvature",)), bar(2 * pieces, ("curvature",))
        share = np.full(2 * pieces + 1, 4 / 3)
        share[::2] = 2 / 3
        both = np.kron(np.eye(pieces), np.ones((2, 1)))
        shape = fine.shape(fine.layout.at_rest())
        mass = both.T @ shape.mass(share[:, None, None] * fine.inertia) @ both
        tangent = both.T @ fine.tangent(shape, Level()) @ both
        square = float(eigh(tangent, mass, eigvals_only=True)[2])
        found = (_third(rod), math.sqrt(square) / (2 * math.pi))
        rows.append([pieces, *(f"{each / aim - 1:+.2e}" for each in found)])
    return "\n".join(table(["pieces", "ends", "Simpson"], rows))


def _third(rod: Rod) -> float:
    return float(modes(rod, rod.shape(rod.layout.at_rest()), Level(), 3).frequencies[2])


def rubber(points: Floats) -> tuple[Floats, Floats]:
    """A neo-Hookean section, μ = E/3, whose lines of height y stretch by λ − k y, under a pressure.

    Args:
        points: λ, k in 1/mm and P in MPa, (n, 3).

    Returns:
        Φ, (n,), N, and its slopes, (n, 3).
    """
    stretch, k, pressure = points.T
    nodes, weights = np.polynomial.legendre.leggauss(12)
    y, area = HEIGHT / 2 * nodes, AREA / 2 * weights
    lines = stretch[:, None] + k[:, None] * y
    stress = YOUNG / 3 * (lines - 1 / lines**2)
    chamber = 30.0 * stretch + 250.0 * k
    value = YOUNG / 6 * (lines**2 + 2 / lines - 3) @ area - pressure * chamber
    slopes = [stress @ area - 30 * pressure, (stress * y) @ area - 250 * pressure, -chamber]
    return value, np.column_stack(slopes)


def tables() -> str:
    """Points and errors of tables, and of a rod by them under weight and pressure."""
    rows = []
    ranges = ((0.85, 1.3), (-0.02, 0.04), (0.0, 0.5))
    found: list[Floats] = []
    for error in (1e-3, 1e-4, 1e-5):
        law = tabulate(rubber, ranges, error)
        plain = bar(48, NO_SHEAR)
        rod = Rod(plain.layout, law, plain.inertia, plain.terms)
        path = Path(Level(), Level(0.3, (1.0,)))
        rest = rod.layout.at_rest()
        state = march(rod, rest, path, STEPS)[-1]
        angle = float(np.sum(rod.layout.weights("curvature") * state.strains))
        found.append(np.array([angle, *state.shape.places[-1, 1:]]))
        cost = least(lambda: march(rod, rest, path, STEPS)) / len(STEPS)  # noqa: B023
        lines = " × ".join(str(len(axis.lines) - 1) for axis in law.axes)
        rows.append([f"{error:.0e}", lines, len(law.samples.values), law.errors.max(), cost])
    for row, each in zip(rows, found, strict=True):
        away = float(np.linalg.norm(each[1:] - found[-1][1:]))
        row[3:] = [f"{row[3]:.1e}", f"{each[0] / found[-1][0] - 1:+.1e}", f"{away:.4f} mm",
                   f"{row[4]:.1f} ms"]  # fmt: skip
    head = ["error asked for", "intervals", "points", "error", "angle", "tip", "a state"]
    return "\n".join(table(head, rows))


def least(work: Callable[[], object], count: int = 12) -> float:
    """Least processor time of a call, ms."""
    times = []
    for _ in range(count):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return 1e3 * min(times)


def costs() -> str:
    """Processor time of states and steps in time."""
    rows = []
    for name, strains in (("plane", NO_SHEAR), ("space", ("stretch", "curvature"))):
        free = strains if name == "plane" else (*strains, "side_curvature", "twist")
        layout = Layout(np.full(48, LENGTH / 48), free)
        law = Linear(np.diag([AXIAL, *(BENDING for _ in free[1:])]), layout.at_rest()[0])
        masses = bar(48, NO_SHEAR).inertia
        terms = (Weight(masses, WEIGHT), TipForce((0.0, -0.1, 0.0)))
        rod = Rod(layout, law, masses, terms)
        path = Path(Level(), Level(amounts=(1.0, 1.0)))
        state = least(lambda: march(rod, layout.at_rest(), path, STEPS)) / len(STEPS)  # noqa: B023
        motion = Motion(rod, lambda time: Level(amounts=(1.0,)), 0.005 * np.diag(law.stiffness))
        begin = motion.at(layout.at_rest())
        step = least(lambda: list(motion.run(begin, 5e-3, 10)), 4) / 10  # noqa: B023
        rows.append([name, layout.at_rest().size, f"{state:.1f} ms", f"{step:.1f} ms"])
    return "\n".join(table(["48 pieces", "unknowns", "a state", "a step of 5 ms"], rows))


if __name__ == "__main__":
    for part in (discretisations, shear_share, rules_of_mass, costs, tables):
        print(part(), end="\n\n")
