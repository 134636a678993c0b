"""Displacement and pressure fit together: no locking, no spurious pressures, on any mesh."""

from __future__ import annotations

import pytest
import scipy.sparse as sp

from tests.hard.infsup import LADDERS, Ladder, constants, least

STAYS = 0.8
"""β over that of the mesh before. The last step of a ladder takes h to a half or two thirds: the
constant of a pair that locks falls as h, that is by as much."""


@pytest.mark.parametrize(
    "ladder",
    [
        pytest.param(
            ladder,
            marks=() if ladder.model == "section" else pytest.mark.hard,
            id=f"{ladder.name}-{ladder.model}-{ladder.angle:g}",
        )
        for ladder in LADDERS
    ],
)
def test_the_inf_sup_constant_stays_away_from_zero(ladder: Ladder) -> None:
    betas = [beta for _, beta in constants(ladder)]
    assert betas[-1] > 0.25
    assert betas[-1] > STAYS * betas[-2]


def test_a_known_constant() -> None:
    # K = 1, B = (b, 0), M = 1: β = b, the least of two
    b = sp.csr_matrix([[0.5, 0.0, 0.0], [0.0, 0.25, 0.0]])
    assert least(sp.identity(3), b, sp.identity(2)) == pytest.approx(0.25)
