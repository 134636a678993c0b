"""Fig. 4(b) and eqs. (1) to (3), (A1) to (A16): which shape of the section is easiest to bend."""

from __future__ import annotations

import math

import numpy as np

from analytic.equal_area import SHAPES, EqualArea, text_torques
from bench.paper.lines import BLUE, GREEN, RED, named, page
from bench.paper.part import Erratum, Figure, Found, Table
from bench.paper.runs import Runs
from bench.paper.verdict import Verdict, holds, percent, rounded, used

SIDE, LENGTH = 10.0, 160.0
"""a and L in mm; the paper gives neither for its figure: a and L are assumed."""
SAME = 1e-9
_COLORS = dict(zip(SHAPES, (BLUE, GREEN, RED), strict=True))


def found(_runs: Runs) -> Found:
    """Resistances of the three shapes, and the numbers of the appendix."""
    exact, printed = EqualArea(SIDE, LENGTH), EqualArea(SIDE, LENGTH, rounded=True)
    wrong = EqualArea(SIDE, LENGTH, paper=True)
    full = 2 * math.pi
    rows = [
        [
            shape,
            f"{exact.torque(shape) / SIDE**3:.4f}",
            *(f"{1e3 * float(exact.resistance(shape, x)):.1f}" for x in (full / 4, full / 2, full)),
            f"{1e3 * float(printed.resistance(shape, full)):.1f}",
        ]
        for shape in SHAPES
    ]
    head = ("shape", "M_a/(a³ P)", "90°", "180°", "360°", "360° with 0.80 a, 0.56 a, v = 1.46")
    caption = (
        "Bending resistance M_θ/(M_a/P), kPa; a = 10 mm, t = 2.5 mm, L = 160 mm, μ̄ = 0.314 MPa"
    )
    text = text_torques(exact.aspect)
    return Found(
        words=(
            "The paper bends a rectangle, a hemicircle and a circle of the same chamber area a² in "
            "closed form, and chooses the one that needs the least pressure.",
        ),
        figures=[Figure("fig4", _draw(exact), "Bending resistance of the three shapes.")],
        tables=[Table(caption, head, rows)],
        verdicts=verdicts(exact),
        errata=[
            Erratum(
                "(1) to (3) beside (A2), (A5), (A8)",
                f"0.5/v = {text['rectangle']:.3f}, 0.34 and 0.72, in units of a³ P: (1) and (2) "
                "leave out the wall between chamber and fulcrum, and (3) is neither with it, 0.80, "
                "nor without, 0.55",
                "the appendix: "
                + ", ".join(f"{exact.torque(shape) / SIDE**3:.3f}" for shape in SHAPES)
                + " from the exact geometry; these alone give the paper's conclusion",
            ),
            Erratum(
                "(A12), (A13), (A15)",
                "an extra factor L: the hemicircle's resistance is then "
                f"{float(wrong.resistance('hemicircle', full)):.1f} N/mm instead of a pressure; "
                "in (A15) dφ and dc are exchanged, and r_FC is once called r_FT",
                "without L, and the integral over the ring",
            ),
        ],
    )


def verdicts(exact: EqualArea) -> list[Verdict]:
    """On the numbers of III-A and the appendix."""
    v = exact.aspect
    half, full = (radius / SIDE for radius in exact.radii)
    torque = {shape: exact.torque(shape) / SIDE**3 for shape in SHAPES}
    angles = np.radians(np.linspace(1.0, 360.0, 360))
    box, dome, tube = (exact.resistance(shape, angles) for shape in SHAPES)
    model = "exact geometry"
    text = text_torques(v)["rectangle"]
    # the first moment of the chamber about the floor's lower face: its area by its middle
    moment = 1 / 4 + 1 / (2 * v)
    apart = float(np.max(np.abs(box / tube - 1)))
    nearest = float(np.min(np.minimum(box, tube) / dome - 1))
    return [
        holds(
            "box",
            model,
            f"{torque['rectangle']:.3f} a³ P",
            abs(text / torque["rectangle"] - 1) < 0.01,
            f"0.5/v = {text:.3f}: {percent(text / torque['rectangle'] - 1)}",
        ),
        rounded("half", model, torque["hemicircle"]),
        rounded("full", model, torque["circle"]),
        holds(
            "box_a",
            model,
            f"{moment:.4f} a³ P",
            abs((1 + 0.5 * v) / (2 * v) / moment - 1) < SAME,
            f"the chamber's first moment is the same at v = {v:.4f}",
        ),
        rounded("half_a", model, torque["hemicircle"]),
        rounded("full_a", model, torque["circle"]),
        rounded("aspect", model, v),
        rounded("aspect_text", model, v),
        rounded("half_radius", model, half),
        rounded("full_radius", model, full),
        rounded("half_width", model, 2 * half),
        rounded("box_width", model, v),
        rounded("box_height", model, 1 / v),
        used("share", exact.wall / SIDE, model),
        holds(
            "easiest",
            "closed form",
            f"{1e3 * dome[-1]:.1f} kPa at 360°",
            bool(np.all((dome < box) & (dome < tube))),
            f"the others need at least {percent(nearest)} at every angle to 360°",
        ),
        holds(
            "alike",
            "closed form",
            f"up to {100 * apart:.1f} % apart",
            apart < nearest,
            f"nearer to each other than to the hemicircle, {percent(nearest)} or more above it",
        ),
    ]


def _draw(exact: EqualArea) -> object:
    angles = np.linspace(0.0, 360.0, 181)
    figure, panel = page(4.2)
    for shape in SHAPES:
        values = 1e3 * exact.resistance(shape, np.radians(angles))
        panel.plot(angles, values, color=_COLORS[shape], lw=1.8, label=shape)
    named(panel, "bending angle, °", "bending resistance $M_θ/(M_a/P)$, kPa")
    panel.set_xlim(0, 360)
    panel.set_xticks(range(0, 361, 90))
    panel.set_ylim(bottom=0)
    panel.legend(fontsize=11, loc="upper left")
    figure.tight_layout()
    return figure
