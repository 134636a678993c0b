"""What changes of fem/ the tests did not notice: found by bench/mutants.py, judged by hand."""

from __future__ import annotations

import dataclasses
from textwrap import fill

TITLE = "Lines changed on purpose: what the tests did not notice"
POSSIBLE, SAMPLE = 1214, 100
"""Mutants of the kinds in bench/mutants.py, and how many of them were run."""


@dataclasses.dataclass(frozen=True)
class Mutant:
    """A change that the tests of its area in tests/fem did not notice.

    Attributes:
        source: the file, below fem/.
        change: before and after.
        meaning: what it changes.
        verdict: why it survives, or what now notices it.
        number: of such mutants in the sample.
    """

    source: str
    change: str
    meaning: str
    verdict: str
    number: int = 1


GAP, SAME, SPEED, GUARD = "gap, now tested: ", "equivalent: ", "only speed", "guard alone: "

MUTANTS = (
    Mutant("solver/newton.py", "`self.solves = 0` → `-1`", "iterations told", GAP + "test_newton"),
    Mutant(
        "solver/newton.py",
        "`if not converged and not self.reason` → `if converged and …`",
        "the reason of a start that has no value, and of a solve that converged",
        GAP + "test_newton",
    ),
    Mutant(
        "solver/newton.py",
        "`> 1e3 * min(size[:-1])` → `> 1e3 / min(…)`",
        "when a growing residual is given up",
        GAP + "test_newton",
    ),
    Mutant(
        "solver/newton.py",
        "`> 1e3 * min(size[:-1])` → `>= …`",
        "the same on a tie",
        SAME + "no two residuals are in that ratio to the last digit",
    ),
    Mutant(
        "solver/newton.py",
        "`fast` (now in solver/reuse.py): `not self.tangents` → `not not …`",
        "when a factor is used again",
        SPEED + ", now tested all the same: test_newton",
    ),
    Mutant("solver/newton.py", "`fast`: `history[-1]` → `[-2]`", "the same", "the same"),
    Mutant("solver/newton.py", "`fast`: `len(history) - 1` → `+ 1`", "the same", "the same"),
    Mutant("solver/newton.py", "`fast`: `and` → `or`", "the same", "the same"),
    Mutant(
        "solver/newton.py",
        "`self.least > 0` → `>= 0` in the reason",
        "words at det F = 0",
        SAME + "det F is never 0 to the last digit",
    ),
    Mutant(
        "solver/newton.py",
        "`scalars if self.last` → `if not self.last` before a broadcast",
        "scalars on several ranks",
        "noticed on two ranks by test_ranks, which was not among the tests of the area",
    ),
    Mutant(
        "solver/newton.py",
        "`schur = zeros((0, 0))` → `(0, 1)`",
        "a placeholder before the first factor",
        SAME + "nobody reads it before",
    ),
    Mutant(
        "march/march.py",
        "`abs(target - now)` → `target + now` after a failure",
        "the next increment: the one that failed again where a stop had clipped it",
        GAP + "test_increments",
    ),
    Mutant(
        "march/march.py",
        "`slow = outcome if … >= slow` → `if not …`",
        "which increments shrink, and whether creeping ends",
        GAP + "test_increments",
    ),
    Mutant(
        "march/march.py",
        '`kind == "limit" and scalar == …` → `or`',
        "which point ends the way beyond a limit",
        GAP + "test_increments",
    ),
    Mutant(
        "march/march.py",
        "`(1 - share) * value` → `(1 + share)`",
        "pressure and angle at which a body meets itself",
        GAP + "test_increments",
    ),
    Mutant(
        "march/march.py",
        "`assess_stability(new, states[-1])` → `states[0]`",
        "the state with which the count of modes is compared",
        SPEED + ", but for two changes of stability of different kinds within three steps, "
        "which no test has",
    ),
    Mutant(
        "march/march.py",
        "`jump * step + 1e-6 * abs(now)` → `- 1e-6 …`",
        "the tolerance of a jump to another branch",
        "only a tolerance: a millionth of the volume",
    ),
    Mutant(
        "results/measures.py",
        "`total *= [0, 2, 2, 2, 0, 0]` → `[0, 2, 2, 1, 0, 0]`",
        "the moment of half a body",
        GAP + "test_resultants",
    ),
    Mutant(
        "results/measures.py",
        "`self.force + other.force` → `-`",
        "the sum of two resultants; in `balance` the sign of all forces alike",
        GAP + "test_resultants",
    ),
    Mutant(
        "results/measures.py",
        "`nodes[…, 2].mean()` → `nodes[…, 1]` of the end sections",
        "the length over which the middle's angle is taken",
        GAP + "test_turns",
    ),
    Mutant(
        "results/measures.py",
        "`middle <= length / 4` → `>=`",
        "which stations are the middle half",
        GAP + "test_turns",
    ),
    Mutant(
        "results/measures.py",
        "`polyfit(z, …, 1)` → degree 0",
        "the middle's angle: the mean in place of the slope",
        GAP + "test_turns",
    ),
    Mutant(
        "results/measures.py",
        "nodes of lever `!= 0` → `!= 1`",
        "nodes that weigh nothing are summed too",
        SAME + "zeros are added",
    ),
    Mutant(
        "results/measures.py",
        "`Balance` frozen → not",
        "whether an attribute may be set",
        GUARD + "nobody sets one",
    ),
    Mutant(
        "effects/embedded_fibers.py",
        "`second_derivative`: `return 0.0` → `1.0` where no fiber feels the scalar",
        "slopes of the side conditions, and so the way of Newton's method",
        GAP + "test_side_conditions",
    ),
    Mutant(
        "effects/embedded_fibers.py",
        "`tension_only = False` → `True` by default",
        "nothing that is called",
        SAME + "the winding always says which",
    ),
    Mutant(
        "effects/mean_stretch.py",
        "`reshape(-1, dim)` → `-2`",
        "nothing",
        SAME + "numpy takes any negative number for what is left",
        2,
    ),
    Mutant(
        "effects/mean_stretch.py",
        "`noise`: norm along another axis",
        "the estimate of round-off below which forces do not count",
        "only a tolerance, of the same order",
    ),
    Mutant(
        "kinematics/uniform.py",
        "`AXES = {…, TWIST: 2}` → `1`",
        "the axis about which fibers twist; the rubber's stays",
        GAP + "test_screw. Residual and tangent belong to one potential, be it a wrong one",
    ),
    Mutant(
        "kinematics/cell.py",
        "`x = (…, u[2])` → `u[1]`, and `position[1]` → `[2]`",
        "positions in a slice, and so F under bending",
        GAP + "test_screw",
        2,
    ),
    Mutant(
        "kinematics/cell.py",
        "`plane`: a `0` → `-1`, in two places",
        "F in a slice: a constant shear",
        GAP + "test_screw",
        2,
    ),
    Mutant(
        "kinematics/cell.py",
        "`comm.size > 1` → `> 2`",
        "whether a slice with tied ends is refused on two ranks",
        GAP + "test_screw",
    ),
    Mutant(
        "kinematics/uniform.py",
        "`x`: `_relative()[0]` → `[1]`",
        "positions that no effect of a section asks for yet",
        GAP + "test_screw",
    ),
    Mutant(
        "kinematics/uniform.py",
        "`CurvatureAngle.slope`: `==` → `!=`",
        "the way of Newton's method to a given angle",
        GAP + "test_side_conditions",
    ),
    Mutant(
        "kinematics/uniform.py",
        "`size_of`: `1 / height` → `2 / height`",
        "the scale of moments and torques in the tolerance",
        GAP + "test_side_conditions",
    ),
    Mutant(
        "kinematics/domain.py",
        "degree of quadrilaterals `5` → `4`",
        "nothing",
        SAME + "three Gauss points either way",
    ),
    Mutant(
        "solver/side_conditions.py",
        "`Stationary`: sign of the value, `/` → `*` in value and slope, `*` → `/` in the scale",
        "natural scalars: the way of Newton's method and the tolerance",
        GAP + "test_side_conditions. Tests in tests/run alone had run these lines",
        4,
    ),
    Mutant(
        "solver/side_conditions.py",
        "`max(abs(target), 1e-30)` → `1.0`",
        "the tolerance of volumes below 1 mm³",
        GAP + "test_side_conditions",
    ),
    Mutant(
        "solver/side_conditions.py",
        "`max(abs(target), 1e-30)` → `-1.0`",
        "a volume of exactly 0 as a target",
        GUARD + "no ramp has it",
    ),
    Mutant(
        "solver/bordered.py",
        "rows at fixed dofs `0.0` → `-1.0`",
        "nothing",
        SAME + "what they multiply is zero there",
    ),
    Mutant(
        "solver/bordered.py",
        "`zip(…, strict=True)` → `False`",
        "nothing",
        GUARD + "both have the length of the unknown scalars",
    ),
)

MISSED = sum(mutant.number for mutant in MUTANTS)
GAPS = sum(mutant.number for mutant in MUTANTS if mutant.verdict.startswith(GAP))
TEXT = (
    "Small changes of the kind that a slip of the pen makes (a sign, a comparison, a number by "
    "one, and for or), by cosmic-ray 8.7, in Newton's method, march, measures, embedded fibers, "
    f"kinematics and bordered systems: {SAMPLE} of {POSSIBLE} possible ones, drawn with a fixed "
    "seed, the same number in each of the six, one at a time. Against each ran the fast tests of "
    "its area in tests/fem that reach the changed line, the quickest first, for half a minute of "
    "their time at most; longer tests, and those in tests/run, were not asked. "
    f"{SAMPLE - MISSED} were noticed, {MISSED} were not; {GAPS} of these change an answer, a "
    "reason, a tolerance or the way to an answer, and have a fast test since. `bench/mutants.py` "
    "makes and runs such a sample, against whole files of tests; what a survivor means is judged "
    "by hand, in tests/verify/mutants.py. Two changes made by hand before are noticed since as "
    "well: Newton's convergence without its tolerance of volumes (test_newton), and whole turns of "
    "the bending angle rounded up from 0.6 on (test_turns). The sample was drawn before the angle "
    "became that of the centre-line: results/measures.py and march.py had code then that is now in "
    "results/centre_line.py, where nothing is rounded to turns, and in march/attempts.py, "
    "increments.py and ways.py."
)


def _row(*cells: str) -> str:
    return "| " + " | ".join(cells) + " |"


def mutants_section() -> str:
    """The survivors as a table."""
    lines = [f"## {TITLE}", "", fill(TEXT, 100), ""]
    lines.append(_row("source", "change", "what it changes", "why it survives, or what notices it"))
    lines.append(_row("---", "---", "---", "---"))
    for m in MUTANTS:
        times = f" ({m.number} mutants)" if m.number > 1 else ""
        lines.append(_row(m.source, m.change + times, m.meaning, m.verdict))
    return "\n".join(lines) + "\n"
