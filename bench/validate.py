"""`make validate`: figures of this program beside those that no one here wrote.

Writes docs/validation.md, and bench/outside/record.json with the same rows. A minute of
processor time.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from bench.outside import beam, braid, held, others, twist
from bench.outside.table import Row, load, page, save

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "validation.md"
RECORD = ROOT / "bench" / "outside" / "record.json"
PARTS: dict[str, Callable[[], list[Row]]] = {
    "tubes that twist": twist.rows,
    "tubes whose ends are held": held.rows,
    "a beam": beam.rows,
    "the exact tube": braid.rows,
    "bending actuators": others.rows,
}
SOURCES = {
    "Bruder 2017": "D. Bruder, University of Michigan: twist and extension of four tubes on their "
    "first loading, inner radius 3/16 in, wall 1/16 in, length 3.4 in; "
    "github.com/bruderd/UM-Matlab at 80fc221, FREE/StressModel_1fibfam. No licence: only these "
    "figures are quoted.",
    "Bruder 2018": "D. Bruder, A. Sedal, R. Vasudevan, C. D. Remy, Force generation by parallel "
    "combinations of fiber-reinforced fluid-driven actuators, IEEE RA-L, arXiv 1805.00124: radius "
    "5 mm, length 100 mm; slopes by regression over the states of TRI/IROS2018/testData_9 of the "
    "same repository, its signs turned. No licence: only these figures are quoted.",
    "Dubied 2022": "M. Dubied, M. Michelis, A. Spielberg, R. Katzschmann, Sim-to-real for soft "
    "robots using differentiable FEM, arXiv 2201.12560: markers on a beam of 30 × 30 × 100 mm, "
    "clamped at one end; github.com/srl-ethz/diffPD_sim2real at 825e7b7, MIT. "
    "bench/outside/data has the markers and the licence.",
    "COMSOL": "the same repository: COMSOL's values for E = 264 kPa, ν = 0.499, 1070 kg/m³, the "
    "load along the upper edge of the free end.",
    "theory": "the exact solution of a thick tube of incompressible rubber with fibers around it, "
    "by analytic/tube.py: J. E. Adkins and R. S. Rivlin 1955, Phil. Trans. R. Soc. A 248, 201.",
    "torsion": "R. S. Rivlin 1949, Phil. Trans. R. Soc. A 242, 173: π μ ψ (B⁴ − A⁴)/2.",
    "braid": "the textbooks' angle of a braid of fixed lengths under pressure, tan² α = 2.",
    "Polygerinos 2015": "P. Polygerinos et al., IEEE T-RO 31(3), doi 10.1109/TRO.2015.2428504: its "
    "eq. (19), worked out independently, and the trends of its Table II; `make sweep` has all "
    "points.",
    "independent": "a section and a cell of the same actuator that were solved independently of "
    "this project; docs/evidence/uniform.md.",
    "CalculiX C3D20R": "CalculiX 2.20, run by `make peers`; docs/evidence/peers.md.",
    "felupe": "felupe 11.3.0, run by `make peers`; docs/evidence/peers.md.",
}


def text() -> str:
    """The page of the rows that are kept."""
    return page(*load(RECORD), SOURCES)


def main() -> None:
    """Compute all rows, keep them and write the page."""
    start, rows = time.process_time(), []
    for name, part in PARTS.items():
        print(f"{name} …", flush=True)
        rows += part()
    save(RECORD, rows, time.process_time() - start)
    PAGE.write_text(text(), encoding="utf-8")
    for row in rows:
        if row.holds is False:
            print(f"not as near as asked: {row.subject}, {row.quantity}")
    print(f"validate: {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
