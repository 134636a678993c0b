"""Fabrics and papers of strips and layers; MPa, mm and kg/m³."""

from __future__ import annotations

from materials.named.entry import Sheet, Source

SHEETS = (
    Sheet(
        name="printer-paper",
        product="printer paper",
        sort="paper",
        modulus=5320.0,
        source=Source(
            "preprint on corrugated structures of self-folding paper, figure S1",
            "https://www.authorea.com/users/450520/articles/549430",
            "numbers of a publication",
        ),
        tested="tension of three strips 100 mm × 15 mm, slope up to a strain of 0.25 %",
    ),
)
