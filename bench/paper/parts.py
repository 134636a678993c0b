"""The parts of the page, in their order."""

from __future__ import annotations

from bench.paper.figures import (
    assumed,
    fig4,
    fig6,
    fig8,
    fig9,
    fig10,
    fig11,
    fig13,
    inputs,
    table1,
    table2,
)
from bench.paper.part import Part

PARTS: tuple[Part, ...] = (
    Part("fig4", "Fig. 4(b): three shapes of the section", fig4.found),
    Part("fig6", "Fig. 6: the baseline at 360°", fig6.found),
    Part("fig8", "Fig. 8: radius, length and wall", fig8.found),
    Part("fig9", "Fig. 9: path of the tip", fig9.found),
    Part("fig10", "Fig. 10: pressure and angle", fig10.found),
    Part("fig11", "Fig. 11: force of a blocked tip", fig11.found),
    Part("fig13", "Fig. 13: feedback control", fig13.found),
    Part("table1", "Table I: what it costs", table1.found),
    Part("table2", "Table II: trends", table2.found),
    Part("assumed", "Open assumptions: what they cost, and what explains the paper", assumed.found),
    Part("inputs", "Inputs: dimensions, materials, procedures", inputs.found),
)
