"""Displacement and pressure fit together: no locking, no spurious pressures, on any mesh."""

from __future__ import annotations

import pytest
import scipy.sparse as sp

from bench.hard_infsup import LADDERS, Ladder, constants, fault, least


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
    assert fault([beta for _, beta in constants(ladder)]) == ""


@pytest.mark.parametrize("betas", [[0.5, 0.3, 0.2], [0.5, 0.4, 0.3], [0.6, 1e-9, 1e-9]])
def test_a_constant_that_falls_is_a_fault(betas: list[float]) -> None:
    assert fault(betas)


def test_a_known_constant() -> None:
    # K = 1, B = (b, 0), M = 1: β = b, the least of two
    b = sp.csr_matrix([[0.5, 0.0, 0.0], [0.0, 0.25, 0.0]])
    assert least(sp.identity(3), b, sp.identity(2)) == pytest.approx(0.25)
