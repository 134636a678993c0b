"""Threads of windings; MPa, mm and kg/m³."""

from __future__ import annotations

from materials.named.entry import Source, Thread
from materials.named.published import PAPER

_ROPES = Source(
    "Tension Technology International, synthetic fibre yarn properties, table 1 (specific modulus "
    "in N/tex times specific gravity)",
    "https://tensiontech.cn/papers/deep-mor/synthetic-fibre-yarn-properties-table-1",
    "numbers of a publication",
)
_FIBERS = Source(
    "table 1 of Scientific Reports 11 (2021) 8705", "10.1038/s41598-021-87957-7", "CC BY 4.0"
)
_YARN = "tension of yarn, typical values; a twisted or braided thread is softer than its yarn"
_SINGLE = "tension of single filaments; a twisted or braided thread is softer"
_DENSITY = "the same table"

THREADS = (
    Thread(
        name="kevlar",
        product="Kevlar thread",
        modulus=31076.0,
        diameter=0.38,
        radius_factor=0.5,
        source=Source(f"{PAPER.text}, section III-C: radius halved", PAPER.address, PAPER.licence),
        tested="not stated",
    ),
    Thread(
        name="kevlar-29",
        product="Kevlar 29 yarn",
        modulus=49.0 * 1440.0,
        density=1440.0,
        density_source=_DENSITY,
        source=_ROPES,
        tested=_YARN,
    ),
    Thread(
        name="kevlar-49",
        product="Kevlar 49 yarn",
        modulus=78.0 * 1440.0,
        density=1440.0,
        density_source=_DENSITY,
        source=_ROPES,
        tested=_YARN,
    ),
    Thread(
        name="polyester",
        product="polyester yarn",
        modulus=10.0 * 1380.0,
        density=1380.0,
        density_source=_DENSITY,
        source=_ROPES,
        tested=_YARN,
    ),
    Thread(
        name="nylon",
        product="nylon yarn",
        modulus=4.0 * 1140.0,
        density=1140.0,
        density_source=_DENSITY,
        source=_ROPES,
        tested=_YARN,
    ),
    Thread(
        name="vectran-yarn",
        product="Vectran",
        modulus=46.0 * 1410.0,
        density=1410.0,
        density_source=_DENSITY,
        source=_ROPES,
        tested=_YARN,
    ),
    Thread(
        name="vectran",
        product="Vectran",
        modulus=65000.0,
        source=_FIBERS,
        tested=_SINGLE,
        note="the table has 60 GPa of another source too",
    ),
    Thread(
        name="technora",
        product="Technora",
        modulus=71000.0,
        source=_FIBERS,
        tested=_SINGLE,
    ),
    Thread(
        name="zylon",
        product="Zylon",
        modulus=270000.0,
        source=_FIBERS,
        tested=_SINGLE,
        note="the table has 275 GPa of another source too",
    ),
)
