"""Tip force by contact: Fig. 11 of Polygerinos et al. 2015, what it rests on, and grasping.

Writes docs/contact.md and its pictures. Finished runs are kept in runs/contact and taken again
while their cases stay the same. On one rank.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bench import contact_pictures
from bench.contact_runs import PRESSURES, Solved, carried, fixed, percent, read, solve
from bench.fig11 import KPA, LEVER, MOMENT, Fig11
from bench.tables import ROOT, table

PAGE = ROOT / "docs" / "contact.md"
ROD = "## On a rod\n"
ACTUATORS = ((8, 160), (8, 130), (6, 160))
SHORT: dict[str, Any] = {"length": "24 mm", "cap": "6 mm"}
LEVEL: dict[str, Any] = {"section": "rectangle", "width": "16 mm", "height": "8 mm"}
STIFFNESS = 66.0
"""MPa/mm: what a case with roof and post takes for these materials by default."""
HEAD = """# Tip force by contact

`OPENBLAS_NUM_THREADS=1 python bench/contact.py` makes this page. Obstacles are rigid, have no
friction, and only push. The winding is smeared, elements are 4 mm long. The floor has 2 mm, the
pitch 3 mm, the caps 15 mm. The paper states only the last of these.
"""


def fig11(actuators: Sequence[Fig11]) -> list[str]:
    """The tables of Fig. 11."""
    lines = [
        "## Fig. 11",
        "",
        "'Held': strips of roof (4 mm wide) and post (2 mm long) keep their height, as in "
        "docs/evidence/blocked.md. 'Pushed': a level roof and a post that the body can leave. "
        "L_f = 14 mm reaches to the middle of the post.",
        "",
        "![tip force of the three actuators](images/contact_force.png)",
        "",
        "![the baseline between roof and post, side view](images/contact_blocked.png)",
        "",
        "F L_f is close to κ P, and half of the moment of a section that is kept straight. The "
        "first is a coincidence. Rubber inside the winding passes the pressure on, so the "
        "acting area reaches up to the winding (straight section and cell). But the tip's soft "
        "cap turns and passes only half of that moment on to the post. The roof takes the rest.",
        "",
    ]
    for found in actuators:
        lines += [f"Radius {found.radius} mm, length {found.length} mm:", ""]
        lines += table(["", *KPA], found.rows())
    lines += table(
        [
            "radius, length, mm",
            *[
                f"{support}: {what}"
                for support in ("held", "pushed")
                for what in ("steps; iterations; cut-backs", "balance missed by", "s")
            ],
        ],
        [found.cost() for found in actuators],
    )
    return lines


def ratios(actuators: Sequence[Fig11]) -> list[str]:
    """Of forces at 200 kPa."""
    base, shorter, thinner = actuators
    rows = []
    for name, column, runs in (
        ("body, held", "tip_force_N", "guided"),
        ("body, pushed", "tip_force_N", "contact"),
        ("section kept straight", MOMENT, "section"),
        ("cell kept straight", MOMENT, "cell"),
    ):
        forces = [getattr(a, runs).at(200)[column] for a in (base, thinner, shorter)]
        rows.append([name, *fixed([forces[0] / forces[1], forces[0] / forces[2]], 3)])
    for name, acts in (("κ of eq. (21)", "chamber"), ("κ, area up to the winding", "winding")):
        rows.append([name, f"{base.kappa(acts) / thinner.kappa(acts):.3f}", "1.000"])
    return [
        "## What radius and length do, at 200 kPa",
        "",
        "The paper gives curves without numbers: 'the actuator length has small influence on "
        "force generation, whereas changes in radius have a more significant role' (V-C), and by "
        "its eq. (21) the ratios are those of κ.",
        "",
        *table(["", "radius 8 to 6", "length 160 to 130"], rows),
    ]


def _short(name: str, actuator: dict[str, Any], tip: dict[str, Any]) -> Solved:
    """An actuator with a chamber of 24 mm, to 60 kPa."""
    case = read("fig11/radius8_length160_guided.yaml")
    size = case["actuator"] | SHORT | actuator
    if "width" in actuator:
        del size["radius"]
    case |= {"actuator": size, "output": {"at_pressures": ["20 kPa"]}}
    case["effects"] = [{"pressure": {"to": "60 kPa"}}, case["effects"][1], tip]
    return solve(f"short_{name}", case)


def _roof(actuators: Sequence[Fig11]) -> list[list[str]]:
    """What the roof does, held and pushed, to the first and the last actuator."""
    rows = []
    for found, kpa in ((actuators[0], 100), (actuators[-1], 250)):
        name = f"radius{found.radius}_length{found.length}"
        straight = found.section.at(kpa)[MOMENT]
        for label, support in (("held", "guided"), ("pushed", "contact")):
            roof = carried(name, support, kpa)
            parts = fixed([roof[part] for part in ("all", "rims", "middle")], 3)
            rest = fixed([roof["moment"], straight, roof["angle"]], 1)
            rows.append([f"radius {found.radius} mm, {kpa} kPa, {label}", *parts, *rest])
    return rows


def causes(actuators: Sequence[Fig11]) -> list[str]:
    """Where held and pushed differ."""
    rows = []
    for label, actuator, width, factor in (
        ("round, roof 4 mm", {}, 4, 1),
        ("round, roof 2 mm", {}, 2, 1),
        ("round, roof 1 mm", {}, 1, 1),
        ("level, roof 4 mm", LEVEL, 4, 1),
        ("level, roof 4 mm, obstacles 4 times as stiff", LEVEL, 4, 4),
    ):
        shape = "level" if actuator else "round"
        strip = f"{width} mm"
        held = _short(f"{shape}{width}_held", actuator, {"blocked-tip": {"roof_width": strip}})
        push: dict[str, Any] = {"roof": {"width": strip}, "post": {}}
        if factor > 1:
            push["stiffness"] = f"{factor * STIFFNESS} MPa/mm"
        pushed = _short(f"{shape}{width}_pushed{factor}", actuator, {"contact": push})
        row = [label]
        for kpa in (20, 60):
            forces = [s.at(kpa)["tip_force_N"] for s in (held, pushed)]
            row += [*fixed(forces, 4), *percent(forces[1:], forces[:1])]
        rows.append(row)
    return [
        "## Why held and pushed differ",
        "",
        "- The crown is round. In the held case the rims of the strip carry, which are w²/(8 r) "
        "below the highest line (0.18 mm for w = 4 mm and r = 11 mm). A level roof has to "
        "squeeze the soft sheath before it reaches them. So the pushed force is smaller by an "
        "amount that hardly grows (0.03 to 0.04 N with a radius of 8 mm), and its share falls.",
        "- Strips can pull. In the held case the roof keeps the middle up. In the pushed case "
        "the middle sags away from it, and a body that is bent the other way takes more moment. "
        "So the pushed force is greater by a share that grows, and with a radius of 6 mm this "
        "effect prevails.",
        "- Obstacles yield a little; see the last row of the table of tops.",
        "",
        "The next table has the upward force of the roof in N, and the moment of roof and post "
        "beyond half the length in N mm. This moment is that of a section kept straight. Where "
        "the body sags it is greater, by its share of the free bend.",
        "",
        *table(
            [
                "",
                "roof, all",
                "the strip's two rims",
                "middle half of the length",
                "moment",
                "straight section",
                "middle's angle, °",
            ],
            _roof(actuators),
        ),
        "Narrower strips and a level top remove the loss. What is left is the softness of the "
        "obstacles. "
        "Chamber of 24 mm with caps of 6 mm, where the share is greatest, N "
        "and %:",
        "",
        *table(
            [
                "top",
                *[f"{k} kPa {w}" for k in (20, 60) for w in ("held", "pushed", "differ")],
            ],
            rows,
        ),
    ]


def _off(forces: dict[float, list[float]]) -> list[list[str]]:
    """Rows of two forces by stiffness, and how far they are off for k → ∞, %.

    The error goes with 1/k: what the two stiffest leave, extrapolated.
    """
    *_, (k, low), (stiff, high) = forces.items()
    limit = [(stiff * b - k * a) / (stiff - k) for a, b in zip(low, high, strict=True)]
    return [
        [f"{k:g}", *[f"{v:.4f}" for v in found], *percent(found, limit)]
        for k, found in forces.items()
    ]


def stiffness() -> list[str]:
    """The error of the penalty."""
    held, free = {}, {}
    for factor in (0.25, 0.5, 1, 2, 4):
        push = {"roof": {}, "post": {}, "stiffness": f"{factor * STIFFNESS} MPa/mm"}
        found = _short(f"stiffness{factor}", {}, {"contact": push})
        columns = ("tip_force_N", "roof_force_N")
        held[factor * STIFFNESS] = [found.at(60)[c] for c in columns]
    for k in (3.8, 7.6, 15.2, STIFFNESS):
        bar = {"center": ["-14 mm", "38 mm"], "radius": "6 mm"}
        contact = {"contact": {"cylinder": bar, "stiffness": f"{k} MPa/mm"}}
        found = _short(f"bar{k}", {"length": "48 mm"}, contact)
        columns = ("contact_cylinder_y_N", "contact_cylinder_z_N")
        free[k] = [found.at(60)[c] for c in columns]
    return [
        "## What the obstacles' stiffness costs",
        "",
        "Contact is a penalty: under a pressure p an obstacle yields by p/k. By default k is a "
        "hundred times the modulus over the thickness of what touches. This is the sheath, so k "
        "is 7.6 MPa/mm here. Between roof and post, where nothing else yields, the modulus is "
        "that of the wall, and k is 66 MPa/mm. "
        "The short actuator at 60 kPa; off in % of the value for k → ∞. "
        "Between roof and post:",
        "",
        *table(["k, MPa/mm", "tip, N", "roof, N", "tip off, %", "roof off, %"], _off(held)),
        "Around a bar, with twice the length:",
        "",
        *table(["k, MPa/mm", "up, N", "along z, N", "up off, %", "along z off, %"], _off(free)),
    ]


def grasps() -> tuple[list[str], Solved, Solved]:
    """A bar and a table; the lines and the two runs."""
    bar, plane = (solve(n, read(f"{n}.yaml"), states=True) for n in ("grasp", "grasp_table"))
    lines = [
        "## Meeting an object",
        "",
        "`cases/grasp.yaml`: a bar of 50 mm across the way of the tip; `cases/grasp_table.yaml`: a "
        "table 40 mm under the floor. Force on the body, N; nothing before touch. The "
        "load stepping sees a touch coming, ends its step there, and starts again from the "
        "linear response. Together with obstacles that are no stiffer than needed, this avoids "
        "most failed steps.",
        "",
        "![an actuator around a bar and on a table](images/contact_grasp.png)",
        "",
    ]
    for label, name, found in (("Bar", "cylinder", bar), ("Table", "plane", plane)):
        data = found.run
        touched = data["contact"][name]["touched_at_kPa"]
        lines += [
            f"{label}: touched before {touched[0]:.1f} kPa; {data['load_steps']} steps, "
            f"{data['newton_iterations']} iterations, {data['cutbacks']} cut-backs, "
            f"{data['wall_s']['solve']:.0f} s:",
            "",
        ]
        columns = [f"contact_{name}_{c}" for c in ("y_N", "z_N", "area_mm2", "gap_mm")]
        keep = [r for r in found.rows[1:] if abs(r["pressure_kPa"] % 12.5) < 1e-6]
        lines += table(
            ["P, kPa", "angle, °", "upward, N", "along z, N", "touching, mm²", "gap, mm"],
            [
                [
                    f"{r['pressure_kPa']:g}",
                    f"{r['angle_deg']:.1f}",
                    *[f"{r[c]:.4g}" for c in columns],
                ]
                for r in keep
            ],
        )
    return lines, bar, plane


def main() -> None:
    """Run everything, write the page and its pictures."""
    actuators = [Fig11.solve(*size) for size in ACTUATORS]
    lines = [HEAD, *fig11(actuators), *ratios(actuators), *causes(actuators), *stiffness()]
    grasp, bar, plane = grasps()
    lines += grasp
    images = ROOT / "docs" / "images"
    contact_pictures.forces(actuators, LEVER, PRESSURES, images / "contact_force.png")
    contact_pictures.blocked(actuators[0].contact, images / "contact_blocked.png")
    contact_pictures.grasps(bar, plane, images / "contact_grasp.png")
    # what is said of the rod is written by hand
    _, _, rod = PAGE.read_text(encoding="utf-8").partition(ROD)
    PAGE.write_text("\n".join(lines).rstrip() + f"\n\n{ROD}{rod}", encoding="utf-8")


if __name__ == "__main__":
    main()
