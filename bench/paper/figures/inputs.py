"""What the paper states as inputs, beside what our models take."""

from __future__ import annotations

from bench.paper.facts import BASELINE, STATED, TABLE_I
from bench.paper.part import Erratum, Found
from bench.paper.runs import ROOT, Runs
from bench.paper.verdict import FLAT, Verdict, holds, percent, unknown, used
from fiberbend.reader.reader import read_case
from materials.named.table import named_material, named_thread

CASE = "free_bending.yaml"
"""Of cases/: the baseline, from which all others here are made."""
PROTOCOL = "it is how an experiment was done, and nothing of it enters a model"


def found(runs: Runs) -> Found:
    """Dimensions and materials of the cases, and what no model has."""
    return Found(
        words=(
            "What the paper states of its actuators and experiments, and what the cases of this "
            "page take.",
        ),
        verdicts=[*dimensions(), *materials(), thread(runs), *protocol()],
        errata=[
            Erratum(
                "III-C",
                "U = Σ C_i (I_i − 3)",
                "Yeoh: Σ C_i (I1 − 3)^i, with the same C1 and C2",
            ),
            Erratum(
                "III-C",
                "the radius of the beams is halved, 'an insignificant change in tensile strength'",
                "halving it divides EA by 4 and EI by 16; our thread has the EA of the halved one",
            ),
        ],
        commands=[f"fiberbend validate cases/{CASE}"],
    )


def dimensions() -> list[Verdict]:
    """Of the baseline, and of the third actuator of Fig. 11."""
    actuator = read_case(ROOT / "cases" / CASE).actuator
    where = f"cases/{CASE}"
    names = ("length", "wall", "radius", "cap", "sheath")
    made = [used(name, getattr(actuator, name), where) for name in names]
    made.append(used("thread", named_thread("kevlar").diameter, "named fiber"))
    radii = {size.radius for size in TABLE_I}
    size = STATED["diameter"].value
    made.append(
        holds(
            "diameter",
            "Table I",
            f"radii {', '.join(f'{radius:g}' for radius in sorted(radii))} mm",
            size / 2 in radii,
            f"no radius of {size / 2:g} mm among them, but one of {size:g} mm",
        )
    )
    return made


def materials() -> list[Verdict]:
    """Of rubbers, base and fiber."""
    wall, soft, base = (
        named_material(name) for name in ("elastosil-m4601", "ecoflex-0030", "combined-base")
    )
    thread = named_thread("kevlar")
    moduli = [m.initial_shear_modulus for m in (base, wall, soft)]
    young = [3e6 * value for value in moduli]
    where = "named material"
    return [
        used("c1", wall.parameters["c1"], where),
        used("c2", wall.parameters["c2"], where),
        used("soft_c1", soft.parameters["c1"], where),
        used("soft_c2", soft.parameters["c2"], where),
        used("base", base.parameters["c1"], where),
        used("young", thread.modulus, "named fiber"),
        unknown("poisson", "named fiber", "none", "our thread has no section: EA alone enters"),
        used("halved", thread.radius_factor, "named fiber"),
        used("twice", wall.initial_shear_modulus / wall.parameters["c1"], "Yeoh's law"),
        holds(
            "rubber",
            where,
            f"{young[2]:.2g}, {young[1]:.2g} and {young[0]:.2g} Pa",
            1e2 <= young[2] <= young[1] <= 1e6,
            "3 μ of sheath, wall and base; of these the base is no soft material",
        ),
    ]


def thread(runs: Runs) -> Verdict:
    """On halving the radius of the beams: a cell with a thread of the whole one beside ours."""
    half = runs.cell.sizes[BASELINE].at_angle(360.0)
    whole = runs.whole_thread.at_angle(360.0)
    part = whole / half - 1
    why = "P at 360° with the whole radius, EA four times ours; within 1 % counts as insignificant"
    return holds("insignificant", "cell", percent(part, 2), abs(part) <= FLAT, why)


def protocol() -> list[Verdict]:
    """Of the experiments."""
    return [
        unknown(key, "none", "", PROTOCOL)
        for key in ("specimens", "trials", "blocked", "repeats", "slow")
    ]
