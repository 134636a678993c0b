"""Rubbers whose coefficients somebody has published; MPa and kg/m³."""

from __future__ import annotations

from materials.named.entry import Rubber, Source

PAPER = Source(
    "Polygerinos et al. 2015, IEEE Trans. Robotics 31(3)",
    "10.1109/TRO.2015.2428504",
    "numbers of a publication",
)
_TESTS = (
    "tension by ASTM D638 type IV and compression, both at 500 mm/min; how far the coefficients "
    "were fitted is not stated"
)
_BEAM = Source(
    "Dragon Skin 10 beam of arXiv 2201.12560; Young's modulus 263 824 Pa and Poisson's ratio 0.499 "
    "as chosen there for its motion",
    "https://github.com/srl-ethz/diffPD_sim2real",
    "MIT",
)

PUBLISHED = (
    Rubber(
        name="elastosil-m4601",
        product="Elastosil M4601, Wacker",
        law="yeoh",
        coefficients={"c1": 0.11, "c2": 0.02},
        density=1130.0,
        density_source="Wacker data sheet",
        source=PAPER,
        tested=_TESTS,
        stretches=None,
    ),
    Rubber(
        name="ecoflex-0030",
        product="Ecoflex 00-30, Smooth-On",
        law="yeoh",
        coefficients={"c1": 0.012662, "c2": 0.0},
        density=1070.0,
        density_source="Smooth-On data sheet",
        source=PAPER,
        tested=_TESTS,
        stretches=None,
    ),
    Rubber(
        name="combined-base",
        product="silicone floor with woven glass",
        law="yeoh",
        coefficients={"c1": 7.9, "c2": 0.0},
        source=PAPER,
        tested="chosen so that the floor hardly stretches",
        stretches=None,
        note="rubber floor and strain-limiting layer as one material, of a floor as in the paper",
    ),
    Rubber(
        name="dragon-skin-10-beam",
        product="Dragon Skin 10, Smooth-On",
        law="neo-hooke",
        # E/(2 (1 + ν))
        coefficients={"mu": 0.0880},
        density=1070.0,
        density_source="the same",
        source=_BEAM,
        tested=(
            "a beam of 30 × 30 × 100 mm that bends under its weight and up to 1 N at its tip, "
            "strains up to 12 % by beam theory"
        ),
        stretches=(0.88, 1.12),
    ),
)
