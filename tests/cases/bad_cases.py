"""Wrong input: what is changed in the baseline case, and the line that must come of it."""

from __future__ import annotations

from collections.abc import Iterable

from fiberbend.case.names import MODELS
from geometry.sections.table import SECTIONS
from materials.laws.table import LAWS


def one_of(names: Iterable[str]) -> str:
    """Names as a message lists them."""
    *most, last = names
    return f"{', '.join(most)} or {last}"


BAD_SETTINGS = [
    # unknown keys
    ("actuator.radios=8 mm", "actuator.radios: unknown key, expected one of section, radius"),
    ("colour=red", "colour: unknown key"),
    ("effects.1.winding.angle=3 deg", "effects.1.winding.angle: unknown key"),
    # bare numbers, wrong dimensions
    (
        "actuator.radius=8",
        'actuator.radius: 8, expected a length with its unit such as "8 mm"',
    ),
    ("output.at_angles=[90]", "output.at_angles.0: 90, expected an angle with its unit"),
    ("actuator.radius=8 kPa", 'actuator.radius: "8 kPa", expected a length with its unit'),
    ("effects.0.pressure.to=8 mm", 'effects.0.pressure.to: "8 mm", expected a pressure'),
    # negative, zero, not finite
    ("actuator.wall=-2 mm", 'actuator.wall: "-2 mm", expected a length above zero'),
    ("actuator.length=0 mm", 'actuator.length: "0 mm", expected a length above zero'),
    ("actuator.floor=nan mm", 'actuator.floor: "nan mm", expected a length that is finite'),
    ("actuator.floor=.nan", "actuator.floor: NaN, expected a length with its unit"),
    ("actuator.cap=inf mm", 'actuator.cap: "inf mm", expected a length that is finite'),
    (
        "effects.0.pressure.to=0 kPa",
        'effects.0.pressure.to: "0 kPa", expected a pressure other than zero',
    ),
    ("solver.tolerance=.nan", "solver.tolerance: NaN, expected a finite number"),
    ("mesh.section=0", "mesh.section: 0, expected at least 1"),
    # dimensions against each other
    (
        "actuator.wall=0.01 mm",
        "actuator.wall: 0.01 mm is too thin for elements 1.5 mm long: expected at least 0.06 mm",
    ),
    ("actuator.sheath=0.01 mm", "actuator.sheath: 0.01 mm is too thin"),
    (
        "effects.1.winding.pitch=0 mm",
        'effects.1.winding.pitch: "0 mm", expected a length above zero',
    ),
    # turns that lie over each other, threads that nothing holds
    (
        "effects.1.winding.pitch=0.3 mm",
        'effects.1.winding.pitch: "0.3 mm" lays the turns over each other, 0.3 mm apart where the '
        'thread is 0.38 mm wide, expected at least "0.3801 mm" or a thinner thread',
    ),
    (
        "effects.1.winding.width=4 mm",
        'effects.1.winding.pitch: "3 mm" lays the turns over each other, 3 mm apart where the '
        'ribbon is 4 mm wide, expected at least "4.011 mm" or a thinner ribbon',
    ),
    (
        "effects.1.winding={pattern: single-helix-left, pitch: 100 mm, as: smeared, "
        "fiber: {modulus: 3 GPa, diameter: 56 mm}}",
        'effects.1.winding.pitch: "100 mm" lays the turns over each other, 48.5 mm apart where the '
        "thread is 56 mm wide, expected a thinner thread",
    ),
    (
        "effects.1.winding={pattern: double-helix, pitch: 9 mm, "
        "fiber: {modulus: 3 GPa, diameter: 3.2 mm}}",
        "effects.1.winding.fiber: a thread 3.2 mm thick, expected one not thicker than wall or "
        "floor and sheath together, 3 mm",
    ),
    ("mesh.axial=161 mm", 'mesh.axial: "161 mm", expected elements not longer'),
    ("effects.2.blocked-tip.roof_width=30 mm", "effects.2.blocked-tip: roof half width 15 mm"),
    # steps without an end
    (
        "solver.max_step=1e-9 kPa",
        'solver.max_step: "1e-09 kPa", expected at least a 100000th of "200 kPa"',
    ),
    (
        "solver.max_turn=1e-6 deg",
        'solver.max_turn: "1e-06 deg", expected at least a 100000th of "360 deg"',
    ),
    # unknown names
    ("materials.wall=chewing-gum", 'materials.wall: "chewing-gum", expected '),
    (
        "materials.wall={law: hooke, c1: 1 MPa}",
        f'materials.wall.law: "hooke", expected {one_of(LAWS)}',
    ),
    ("effects.1.winding.fiber=rope", 'effects.1.winding.fiber: "rope", expected '),
    ("effects.2.friction.mu=0.3", "effects.2.friction: unknown key, expected one of pressure"),
    ("effects.1.winding.pattern=braid", 'effects.1.winding.pattern: "braid", expected '),
    ("support=hinge", 'support: "hinge", expected clamped-root'),
    ("model=beam", f'model: "beam", expected {one_of([*MODELS, "auto"])}'),
    (
        "actuator.section=square",
        f'actuator.section: "square", expected {one_of(SECTIONS)}',
    ),
    # dimensions that a section misses or has no use for
    ("actuator.section=rectangle", "actuator.width: missing, expected the width of a rectangle"),
    ("actuator.section=rectangle", "actuator.height: missing, expected the height of a rectangle"),
    ("actuator.section=rectangle", "actuator.radius: no effect on a rectangle, expected no value"),
    ("actuator.width=16 mm", "actuator.width: no effect on a hemicircle, expected no value"),
    ("actuator.radius=", "actuator.radius: missing, expected the radius of a hemicircle"),
    ("actuator.floor=", "actuator.floor: missing, expected the floor of a hemicircle"),
    (
        "actuator={section: circle, radius: 8 mm, length: 160 mm, wall: 2 mm, floor: 3 mm}",
        "actuator.floor: 3 mm, expected at most the wall, 2 mm",
    ),
    (
        "actuator={section: circle, radius: 8 mm, length: 160 mm, wall: 2 mm, floor: 1.99 mm}",
        "actuator.floor: 1.99 mm leaves 0.01 mm of the wall, too thin for elements 1.5 mm long: "
        "expected at most 1.94 mm or all of the wall, 2 mm",
    ),
    (
        "actuator={section: circle, radius: 8 mm, length: 160 mm, wall: 2 mm, layer: 1 mm}",
        "actuator.layer: no effect on a circle, expected no value",
    ),
    (
        "actuator={section: circle, radius: 8 mm, length: 160 mm, wall: 2 mm}",
        "materials.floor: no effect without actuator.floor, expected no value",
    ),
    # shape of the case
    (
        "effects.2.pressure.to=8 kPa",
        "effects.2.pressure: a second pressure, expected one (the first is effects.0)",
    ),
    ("effects=[]", "effects: no load, expected pressure or gravity"),
    ("effects=[pressure]", 'effects.0: "pressure", expected a mapping'),
    ("effects.1={}", "effects.1: {}, expected exactly one effect"),
    ("effects.0={gravity: {direction: -y}, pressure: {to: 1 kPa}}", "effects.0: "),
    ("actuator=", "actuator: nothing, expected a mapping"),
    ("actuator={}", 'actuator.wall: missing, expected a length with its unit such as "8 mm"'),
    ("output.at_angles=90 deg", 'output.at_angles: "90 deg", expected a list'),
    ("output.pictures=1", "output.pictures: 1, expected true or false"),
    ("mesh.section=1.5", "mesh.section: 1.5, expected a whole number"),
    ("title=3", "title: 3, expected text"),
    ("effects.0.pressure={}", "effects.0.pressure: nothing to reach, expected to"),
    ("effects.0.pressure.volume=45 mL", "effects.0.pressure.volume: to is given too"),
    # missing or superfluous companions
    ("materials.sheath=", "materials.sheath: missing, expected the material of actuator.sheath"),
    ("actuator.sheath=", "materials.sheath: no effect without actuator.sheath"),
    ("actuator.layer=1 mm", "materials.layer: missing, expected the material of actuator.layer"),
    ("materials.layer=combined-base", "materials.layer: no effect without actuator.layer"),
    ("materials.wall={law: yeoh}", "materials.wall.c1: missing, expected a coefficient of yeoh"),
    (
        "materials.wall={law: neo-hooke, mu: 1 MPa, c2: 1 MPa}",
        "materials.wall.c2: no effect on neo-hooke, expected no value",
    ),
    (
        "materials.wall={name: elastosil-m4601, c1: 1 MPa}",
        "materials.wall.c1: no effect on a named material, expected no value",
    ),
    (
        "materials.wall={law: mooney-rivlin, c10: 1 MPa, c01: -2 MPa}",
        "materials.wall: initial shear modulus -2 MPa: expected more than 0",
    ),
    (
        "materials.wall={law: mooney-rivlin, c10: 0 MPa}",
        "materials.wall: initial shear modulus 0 MPa: expected more than 0",
    ),
    (
        "materials.wall={law: ogden, mu1: 1 MPa}",
        "materials.wall.alpha1: missing, expected a coefficient of ogden",
    ),
    (
        "materials.wall={law: ogden, mu1: 1 MPa, alpha1: 2, mu2: 1 MPa}",
        "materials.wall.alpha2: missing, expected a coefficient of ogden",
    ),
    (
        "materials.wall={law: ogden, mu1: 1 MPa, alpha1: 2, alpha3: 1}",
        "materials.wall.alpha3: no effect without mu3, expected no value",
    ),
    (
        "materials.wall={law: ogden, mu1: 1 MPa, alpha1: 0}",
        "materials.wall.alpha1: 0, expected a number other than zero",
    ),
    (
        "materials.wall={law: ogden, mu1: 1 MPa, alpha1: 40}",
        "materials.wall.alpha1: 40, expected a number from -25 to 25",
    ),
    (
        "materials.wall={law: ogden, mu1: 1 MPa, alpha1: 2 MPa}",
        'materials.wall.alpha1: "2 MPa", expected a number',
    ),
    (
        "materials.wall={law: ogden, mu1: 1, alpha1: 2}",
        'materials.wall.mu1: 1, expected a modulus with its unit such as "0.11 MPa"',
    ),
    (
        "materials.wall={law: ogden, mu1: 1 MPa, alpha1: 2, mu2: -2 MPa, alpha2: 3}",
        "materials.wall: initial shear modulus -1 MPa: expected more than 0",
    ),
    (
        "materials.wall={law: gent, mu: 1 MPa}",
        "materials.wall.jm: missing, expected a coefficient of gent",
    ),
    (
        "materials.wall={law: gent, mu: 1 MPa, jm: -3}",
        "materials.wall.jm: -3, expected a number above zero",
    ),
    (
        "materials.wall={law: gent, mu: 1 MPa, jm: 3, c2: 1 MPa}",
        "materials.wall.c2: no effect on gent, expected no value",
    ),
    ("actuator.sheath=0 mm", "materials.sheath: no effect without actuator.sheath"),
    ("actuator.layer=-1 mm", 'actuator.layer: "-1 mm", expected a length zero or above'),
    ("materials.wall={density: 1 g/cm^3}", "materials.wall: neither name nor law"),
    (
        "materials.wall={name: elastosil-m4601, density: 1 g/cm^3}",
        "materials.wall.density: no effect without gravity or time, expected no value",
    ),
    (
        "effects.1.winding.fiber={modulus: 3 GPa}",
        "effects.1.winding.fiber.diameter: missing, expected the diameter of an unnamed fiber",
    ),
    (
        "effects.1.winding.fiber={name: kevlar, diameter: 1 mm}",
        "effects.1.winding.fiber.diameter: no effect on a named fiber, expected no value",
    ),
    (
        "effects.1.winding={pattern: double-helix, pitch: 3 mm, fiber: kevlar, as: smeared, "
        "lines: 5}",
        "effects.1.winding.lines: no effect on a smeared winding, expected no value",
    ),
    (
        "effects.1.winding={pattern: double-helix, pitch: 3 mm, fiber: kevlar, width: 0 mm, "
        "lines: 5}",
        "effects.1.winding.lines: 5, expected 1 line where the width is zero",
    ),
    ("output.at_pressures=[300 kPa]", 'output.at_pressures.0: "300 kPa", expected a pressure'),
    ("output.at_pressures=[-10 kPa]", 'output.at_pressures.0: "-10 kPa", expected a pressure'),
    # settings that lead nowhere
    ("effects.7.gravity.direction=-y", "effects.7: no such entry, the list has 2"),
    ("actuator.wall.inner=1 mm", "actuator.wall.inner: no such path"),
    ("actuator.wall", "--set actuator.wall: expected a path and a value"),
    ("actuator.wall=[", "actuator.wall: '[' is not a YAML value"),
]
"""A setting, and how a line of the complaint begins."""

SMEARED = "effects.1.winding.as=smeared"
HOOPS = "effects.1={hoops: {}}"
BLOCKED = "effects.2.blocked-tip={}"
WEIGHT = [
    "effects.2.gravity.direction=-y",
    "materials.floor={law: neo-hooke, mu: 16 MPa, density: 1100 kg/m^3}",
]

UNFIT_MODELS = [
    # turns, twist and ends
    (
        [
            "model=section",
            "effects.0={pressure: {angle: 90 deg}}",
            "effects.2.straight={}",
            "output={}",
        ],
        "effects.0.pressure.angle: no angle is reached where effects.2.straight keeps",
    ),
    (
        ["model=section", "effects.1.winding.as=discrete"],
        "effects.1.winding: model section does not support it: only cell and body have turns",
    ),
    (
        ["model=analytic", "effects.1.winding.width=0.38 mm"],
        "effects.1.winding: model analytic does not support it: only cell and body have turns",
    ),
    (
        ["model=analytic", SMEARED, "effects.1.winding.pattern=single-helix-left"],
        "effects.1.winding: model analytic does not support it: the closed form has no twist",
    ),
    (
        ["model=cell", BLOCKED],
        "effects.2.blocked-tip: model cell does not support it: "
        "roof and post need the ends of a body",
    ),
    (["model=section", BLOCKED], "effects.2.blocked-tip: model section does not support it: "),
    *[
        (
            [f"model={model}", *WEIGHT],
            f"effects.2.gravity: model {model} does not support it: weight",
        )
        for model in ("analytic", "section", "cell")
    ],
    # a slice longer than the chamber that it is to be cut from
    (
        ["model=cell", "effects.1.winding={pattern: double-helix, pitch: 330 mm, fiber: kevlar}"],
        "effects.1.winding: model cell does not support it: the slice that repeats is 165 mm long, "
        "longer than the chamber, 160 mm",
    ),
    (
        [
            "model=cell",
            "effects.1.winding={pattern: single-helix-left, pitch: 165 mm, fiber: kevlar}",
        ],
        "effects.1.winding: model cell does not support it: the slice that repeats is 165 mm long",
    ),
    # what only a uniform bend, or only a closed form, can hold
    (
        ["model=body", "effects.2.straight={}", "output={}"],
        "effects.2.straight: model body does not support it: only a uniform bend is kept straight",
    ),
    *[
        (
            [f"model={model}", HOOPS],
            f"effects.1.hoops: model {model} does not support it: hoops that",
        )
        for model in ("section", "cell", "body")
    ],
    (
        ["effects.2={hoops: {}}"],
        "effects.2.hoops: effects.1.winding fixes the circumference already, expected one of them",
    ),
    # what the closed form needs
    (
        ["model=analytic", "effects.0={pressure: {volume: 45 mL}}"],
        "effects.0.pressure: model analytic does not support it: "
        "the closed form bends by pressure or",
    ),
    (
        ["model=analytic", "materials.floor=elastosil-m4601"],
        "materials.floor: model analytic does not support it: "
        "floor and layer together stretch only",
    ),
    (
        ["model=analytic", "effects=[{pressure: {to: 1 kPa}}]"],
        "effects: model analytic does not support it: no winding fixes the circumference",
    ),
    (
        ["model=analytic", "output.fields=true"],
        "output.fields: model analytic does not support it: closed forms have no fields",
    ),
    (
        [
            "model=analytic",
            "actuator={section: circle, radius: 8 mm, length: 160 mm, wall: 2 mm, floor: 1 mm, "
            "sheath: 1 mm}",
        ],
        "actuator.section: model analytic does not support it: "
        "the closed form is for a hemicircle, not",
    ),
    # uniform bending
    (
        ["model=cell", "mesh.element=tetrahedron"],
        "mesh.element: model cell does not support it: tetrahedra are for a body",
    ),
    (
        ["model=section", "effects=[{gravity: {direction: -y}}]", WEIGHT[1], "output={}"],
        "effects: model section does not support it: nothing bends it uniformly but a pressure",
    ),
    # no model at all
    (
        ["model=auto", HOOPS, BLOCKED],
        'model: "auto", expected effects that one model supports: '
        "analytic not effects.2.blocked-tip "
        "(roof and post are no surfaces of it: closed forms fix the tip rigidly, of a rod the "
        "sheath alone yields, and no section shears: tip force up to 11 % too great, the roof's up "
        "to 30 % (docs/contact.md)); section not effects.1.hoops (",
    ),
]
"""Settings that leave a case right by itself and ask for a model that does not support it."""

BAD_FILES = {
    "malformed": ("actuator: [1, 2\n", "line 2: malformed YAML"),
    "tab": ("actuator:\n\tradius: 8 mm\n", "line 2: malformed YAML"),
    "twice": (
        "title: one\nactuator:\n  wall: 1 mm\n  wall: 2 mm\n",
        "line 4: malformed YAML, key 'wall' a second time, expected once (line 3 has it)",
    ),
    "list": ("- 1\n", "contains no mapping, expected a case"),
    "empty": ("", "contains no mapping, expected a case"),
    "binary": ("\x00\x01", "malformed YAML"),
}
"""Content of a file, and what the complaint about it must hold."""
