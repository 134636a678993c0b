"""Cases whose values contradict each other, and values that slipped by a unit."""

from __future__ import annotations

UNIT_SLIPS = [
    ("actuator.radius=8 km", "actuator.radius", "from 1 um to 100 m", "8 mm"),
    ("actuator.radius=8 nm", "actuator.radius", "from 1 um to 100 m", "8 mm"),
    ("actuator.wall=2e6 mm", "actuator.wall", "from 1 um to 100 m", "2 mm"),
    ("actuator.sheath=1 nm", "actuator.sheath", "from 1 um to 100 m", "1 mm"),
    ("actuator.length=160 km", "actuator.length", "from 1 um to 1 km", "160 mm"),
    ("effects.1.winding.pitch=3000 km", "effects.1.winding.pitch", "from 1 nm to 1 km", "3 mm"),
    ("mesh.axial=1.5e-7 mm", "mesh.axial", "from 1 nm to 1 km", "0.15 mm"),
    ("materials.wall={law: neo-hooke, mu: 1e18 Pa}", "materials.wall.mu", "1 mPa", "1000 MPa"),
    ("materials.wall={law: yeoh, c1: 1 MPa, c2: -1e20 Pa}", "materials.wall.c2", "100 PPa",
     "-100000 MPa"),
    ("materials.wall={law: neo-hooke, mu: 1 MPa, density: 1100 g/cm^3}", "materials.wall.density",
     "from 2.5 kg/m^3 to 30 g/cm^3", "1.1 g/cm^3"),
    ("materials.wall={law: neo-hooke, mu: 1 MPa, density: 1.1 kg/m^3}", "materials.wall.density",
     "from 2.5 kg/m^3 to 30 g/cm^3", "1.1 g/cm^3"),
    ("effects.0.pressure.to=200 TPa", "effects.0.pressure.to", "to 1 TPa", "200 kPa"),
    ("effects.0.pressure.to=200000 kPa", "effects.0.pressure.to", "500 times the shear modulus",
     "200 kPa"),
    ("effects.0.pressure.to=-200 MPa", "effects.0.pressure.to", "500 times the shear modulus",
     "-200 kPa"),
    ("effects.2.gravity={direction: -y, acceleration: 9810 m/s^2}",
     "effects.2.gravity.acceleration", "5000 m/s^2", "9.81 m/s^2"),
    ("output.at_angles=[360 rad]", "output.at_angles.0", "200 rad", "360 deg"),
    ("effects.2.contact.plane={point: [0 mm, -40 km, 0 mm], normal: [0, 1, 0]}",
     "effects.2.contact.plane.point.1", "up to 1 km", "-40 mm"),
]  # fmt: skip
"""A setting, the path of the complaint, a bound that it names, and what was meant."""

CONTRADICTIONS = [
    (
        ["model=section", "effects.2.straight={}"],
        "output.stop_at_angle: no angle is reached where effects.2.straight keeps",
    ),
    (
        ["model=cell", "effects.2.straight={stretch: held}"],
        "output.at_angles.0: no angle is reached where effects.2.straight keeps",
    ),
    (
        ["model=body", "effects.0={pressure: {angle: 30 deg}}", "effects.2.blocked-tip={}"],
        "effects.0.pressure.angle: no angle is reached where effects.2.blocked-tip keeps",
    ),
    (
        ["model=body", "effects.0={pressure: {angle: 30 deg}}",
         "effects.2.contact={roof: {}, post: {}}"],
        "effects.0.pressure.angle: no angle is reached where effects.2.contact keeps",
    ),
    (
        ["model=analytic", "effects.2.straight={}", "effects.3.blocked-tip={}", "output={}"],
        "effects.2.straight: effects.3.blocked-tip keeps it straight already, expected one of them",
    ),
    (
        ["effects.0={pressure: {volume: 45 L}}"],
        'effects.0.pressure.volume: "45000 mL", expected between a hundredth and 1000 times the '
        'chamber at rest, "16.08 mL"',
    ),
    (
        ["effects.0={pressure: {volume: 45 mm^3}}"],
        'effects.0.pressure.volume: "0.045 mL", expected between a hundredth',
    ),
    (
        ["effects.2.gravity.direction=-y",
         *(f"materials.{part}={{law: neo-hooke, mu: 1 MPa, density: 0 g/cm^3}}"
           for part in ("wall", "floor", "sheath"))],
        "materials: nothing has weight, expected a density for gravity",
    ),
]  # fmt: skip
"""Settings that contradict each other, and how a line of the complaint begins."""
