"""Effective modulus from synthetic curves, and the data that give none."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from analytic.bending import Hemicircle
from analytic.calibration import calibrate
from analytic.stress import effective

BASE = Hemicircle(8, 2, 2, 160)
ANGLES = np.radians(np.arange(10, 361, 10))


def test_exact_data_give_the_modulus_back() -> None:
    stiff = dataclasses.replace(BASE, stress=effective(0.271))
    fit = calibrate(stiff.pressure(ANGLES), ANGLES, BASE)
    assert fit.modulus == pytest.approx(0.271, rel=1e-12)
    assert fit.error < 1e-12
    assert fit.points == 36


def test_noisy_data_give_it_within_its_error_bar() -> None:
    random = np.random.default_rng(3)
    exact, noise = BASE.pressure(ANGLES), 0.004
    fits = [calibrate(exact + random.normal(0, noise, 36), ANGLES, BASE) for _ in range(400)]
    assert abs(fits[0].modulus - 0.314) < 3 * fits[0].error
    # Student's t of 35 degrees of freedom: deviation 1.03 ± 0.037, and 0.5 % are beyond 3
    pulls = np.array([(fit.modulus - 0.314) / fit.error for fit in fits])
    assert np.std(pulls) == pytest.approx(1.03, abs=0.11)
    assert np.mean(np.abs(pulls) < 3) > 0.98
    unit = dataclasses.replace(BASE, stress=effective(1.0)).pressure(ANGLES)
    assert fits[0].scatter == pytest.approx(noise, rel=0.4)
    assert fits[0].error == pytest.approx(fits[0].scatter / math.sqrt(unit @ unit), rel=1e-12)


def test_it_fits_the_acting_area_and_the_printed_equation_too() -> None:
    wide = dataclasses.replace(BASE, acts="winding")
    printed = dataclasses.replace(BASE, paper=True)
    exact = BASE.pressure(ANGLES)
    ratio = wide.kappa / BASE.kappa
    assert calibrate(exact, ANGLES, wide).modulus == pytest.approx(0.314 * ratio)
    assert calibrate(exact, ANGLES, printed).modulus == pytest.approx(0.314 / 160)


def test_data_that_give_no_modulus_are_refused() -> None:
    exact = BASE.pressure(ANGLES)
    with pytest.raises(ValueError, match="two lists of one length"):
        calibrate(exact[:-1], ANGLES, BASE)
    with pytest.raises(ValueError, match="too few data: 2 points with an angle, 3 needed"):
        calibrate(np.array([0, 0, 0.05, 0.1]), np.array([0, 0, 1.0, 2.0]), BASE)
    with pytest.raises(ValueError, match="same angle"):
        calibrate(np.array([0.05, 0.06, 0.055]), np.ones(3), BASE)
    with pytest.raises(ValueError, match="pressure 2 is not finite"):
        calibrate(np.array([0.05, np.nan, 0.1]), np.array([1.0, 2, 3]), BASE)
    with pytest.raises(ValueError, match="inconsistent data: the pressures do not rise"):
        calibrate(-exact, ANGLES, BASE)
    with pytest.raises(ValueError, match=r"inconsistent data: the pressures scatter by \d+%"):
        calibrate(exact[::-1].copy(), ANGLES, BASE)
    with pytest.raises(ValueError, match="radians expected"):
        calibrate(exact, np.degrees(ANGLES), BASE)
    sheathed = dataclasses.replace(BASE, sheath=1.0, sheath_stress=effective(0.02))
    with pytest.raises(ValueError, match="leave the sheath out"):
        calibrate(exact, ANGLES, sheathed)
