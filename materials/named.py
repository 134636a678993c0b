"""Named materials, each with the source of its numbers."""

from __future__ import annotations

from materials.material import Material

_PAPER = "Polygerinos et al. 2015, IEEE Trans. Robotics 31(3)"

NAMED: dict[str, Material] = {
    "elastosil-m4601": Material(
        "yeoh",
        {"c1": 0.11, "c2": 0.02},
        density=1130.0,
        source=f"{_PAPER}; density: Wacker data sheet",
    ),
    "ecoflex-0030": Material(
        "yeoh",
        {"c1": 0.012662, "c2": 0.0},
        density=1070.0,
        source=f"{_PAPER}; density: Smooth-On data sheet",
    ),
    "dragon-skin-30": Material(
        "yeoh",
        {"c1": 0.0904, "c2": 0.0091},
        density=1080.0,
        source=(
            "fitted to tensile tests up to a stretch of 2, rms error 0.7 % of the greatest stress: "
            "Marechal et al. 2021, Soft Robotics 8(3), DOI 10.1089/soro.2019.0115; density: "
            "Smooth-On data sheet"
        ),
    ),
    "combined-base": Material(
        "yeoh",
        {"c1": 7.9, "c2": 0.0},
        source=f"{_PAPER}: rubber floor and strain-limiting layer as one material",
    ),
}


def named_material(name: str) -> Material:
    """The material of a name.

    Raises:
        ValueError: an unknown name; lists those that there are.
    """
    if name not in NAMED:
        raise ValueError(f"material {name!r} is unknown: expected one of {', '.join(NAMED)}")
    return NAMED[name]
