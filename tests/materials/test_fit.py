"""Laws fitted to tests: exact recovery, known values, invariance, stability."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fiberbend.tensile.reading import Wanted, read_test
from materials.fit import drucker
from materials.fit.fit import Fit, fit_law
from materials.fit.form import form_of
from materials.fit.modes import EQUIBIAXIAL, MODES, PURE_SHEAR, UNIAXIAL, Measurement, Mode
from materials.fit.search import Problem, search
from materials.laws.law import Deformation, Law, Parameter
from materials.laws.table import LAWS
from materials.material import Material
from tests.conftest import ROOT
from tests.materials.rubber import (
    RUBBERS,
    Floats,
    equibiaxial_stress,
    shear_stress,
    uniaxial_stress,
)

DATA = ROOT / "materials" / "data"
TEXTBOOK: dict[str, Callable[[Material, Floats], Floats]] = {
    "uniaxial": uniaxial_stress,
    "pure-shear": shear_stress,
    "equibiaxial": equibiaxial_stress,
}


def measured(material: Material, *modes: Mode) -> list[Measurement]:
    """What the textbook's formulas say of a material."""
    stretch = np.linspace(0.8, 2.2, 40)
    return [Measurement(m, stretch, TEXTBOOK[m.name](material, stretch)) for m in modes]


def published(name: str, mode: str, most: float, least: float | None = None) -> Measurement:
    """A test that comes with the program."""
    wanted = Wanted(most=most, least=least)
    return read_test(Path(DATA / name), mode, wanted).measurement  # type: ignore[arg-type]


@pytest.mark.parametrize("modes", [[UNIAXIAL], [UNIAXIAL, PURE_SHEAR, EQUIBIAXIAL]])
@pytest.mark.parametrize("law", LAWS)
def test_numbers_come_back(law: str, modes: list[Mode]) -> None:
    # three terms of Ogden's are told apart by several modes alone
    known = RUBBERS[law]
    found = fit_law(law, measured(known, *modes))
    rest = np.concatenate([found.residuals(test) for test in found.tests])
    most = max(np.abs(test.stress).max() for test in found.tests)
    assert np.abs(rest).max() < 1e-5 * most
    if len(found.form.shape) < 3:
        assert found.parameters == pytest.approx(dict(known.parameters), rel=1e-5)
    assert not found.held


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES)
@pytest.mark.parametrize("law", LAWS)
def test_stress_is_the_textbooks(law: str, mode: Mode) -> None:
    stretch = np.linspace(0.7, 1.6, 9)
    found = fit_law(law, measured(RUBBERS[law], UNIAXIAL, PURE_SHEAR, EQUIBIAXIAL))
    expected = TEXTBOOK[mode.name](found.material, stretch)
    assert found.stress(mode, stretch) == pytest.approx(expected, rel=1e-9, abs=1e-12)


KNOWN = {
    "ecoflex-00-30": (7.591, 8.073, 8.602),
    "ecoflex-00-50": (10.438, 11.204, 12.556),
    "dragon-skin-10-medium": (23.193, 28.178, 39.317),
    "dragon-skin-20": (64.956, 80.201, 105.774),
    "dragon-skin-30": (95.779, 111.291, 143.287),
}
"""C1 = μ/2 in kPa of neo-Hooke's law for stretches up to 1.5, 2 and 3."""


@pytest.mark.parametrize("rubber", KNOWN)
def test_moduli_of_published_tests(rubber: str) -> None:
    tests = [published(f"{rubber}.csv", "uniaxial", most) for most in (1.5, 2.0, 3.0)]
    c1 = [500 * fit_law("neo-hooke", [test]).parameters["mu"] for test in tests]
    assert c1 == pytest.approx(KNOWN[rubber], abs=6e-4)


@pytest.mark.parametrize(
    ("rubber", "error"), [("treloar-1944", -35), ("kawabata-1981", -8), ("meunier-2008", -25)]
)
def test_a_mode_that_was_not_measured_errs(rubber: str, error: int) -> None:
    # where nothing keeps it stable: that of Treloar's rubber is not, up to 1.5
    tension = published(f"{rubber}-uniaxial.csv", "uniaxial", 1.5, least=1.0)
    found = fit_law("yeoh-2", [tension], stable=False)
    other = published(f"{rubber}-equibiaxial.csv", "equibiaxial", 1.5)
    end = int(np.argmax(other.stretch))
    relative = found.stress(EQUIBIAXIAL, other.stretch)[end] / other.stress[end] - 1
    assert round(100 * relative) == error


def test_scale_and_order_do_not_matter() -> None:
    test = published("dragon-skin-30.csv", "uniaxial", 2.0)
    for law in ("yeoh-2", "gent", "ogden-1"):
        plain = fit_law(law, [test])
        order = np.random.default_rng(1).permutation(len(test.stretch))
        turned = fit_law(law, [Measurement(UNIAXIAL, test.stretch[order], test.stress[order])])
        assert turned.values == pytest.approx(plain.values, rel=1e-7)
        assert turned.covariance == pytest.approx(plain.covariance, rel=1e-5)
        double = fit_law(law, [Measurement(UNIAXIAL, test.stretch, 2 * test.stress)])
        factors = np.array([2.0] * len(plain.moduli) + [1.0] * len(plain.shape))
        assert double.values == pytest.approx(plain.values * factors, rel=1e-6)
        errors = np.sqrt(np.diag(plain.covariance))
        assert np.sqrt(np.diag(double.covariance)) == pytest.approx(errors * factors, rel=1e-4)


def _stable(found: Fit, reach: float) -> bool:
    """By differences of the energy itself, on states of its own."""
    rng, step = np.random.default_rng(7), 1e-4
    h1 = np.log(reach) * rng.uniform(0.02, 1, 400)
    h2 = h1 * rng.uniform(-0.5, 1, 400)

    def energy(a: Floats, b: Floats) -> Floats:
        return np.asarray(found.material.energy(np.exp(a), np.exp(b), np.exp(-a - b)))

    here = energy(h1, h2)
    moved = {(i, j): energy(h1 + i * step, h2 + j * step) for i in (-1, 0, 1) for j in (-1, 0, 1)}
    a = moved[1, 0] + moved[-1, 0] - 2 * here
    b = moved[0, 1] + moved[0, -1] - 2 * here
    c = (moved[1, 1] + moved[-1, -1] - moved[1, -1] - moved[-1, 1]) / 4
    return bool(np.all(a > 0) and np.all(a * b - c * c > 0))


@pytest.mark.parametrize("law", ["mooney-rivlin", "yeoh-2", "ogden-2"])
def test_a_fit_that_would_be_unstable_is_held(law: str) -> None:
    # a rubber that softens: in equibiaxial tension what fits it best gives way
    stretch = np.linspace(1.0, 1.5, 30)
    soft = 0.3 * (stretch - stretch**-2.0) * np.exp(-1.2 * (stretch - 1))
    test = Measurement(UNIAXIAL, stretch, soft)
    free = fit_law(law, [test], stable=False)
    held = fit_law(law, [test])
    assert free.stability.stretch < 1.5
    assert not _stable(free, 1.5)
    assert held.held
    assert held.stability.stretch >= 1.5
    assert _stable(held, 1.5)
    assert held.free_rms < 1
    assert held.rms > free.rms


def test_nothing_stable_fits_better() -> None:
    # the cutting planes against a fine search of the two moduli
    stretch = np.linspace(1.0, 1.5, 30)
    soft = 0.3 * (stretch - stretch**-2.0) * np.exp(-1.2 * (stretch - 1))
    test = Measurement(UNIAXIAL, stretch, soft)
    held = fit_law("yeoh-2", [test])
    matrix = held.form.stress(UNIAXIAL, stretch, [])
    tangents = drucker.tangents(held.form, [], drucker.states(1.5, 40))
    rest = drucker.tangents(held.form, [], np.zeros((1, 3)))
    best = np.inf
    for c1 in np.linspace(0.8, 1.2, 161) * held.moduli[0]:
        for c2 in np.linspace(0.8, 1.2, 161) * held.moduli[1]:
            moduli = np.array([c1, c2])
            least = np.linalg.eigvalsh(np.tensordot(moduli, tangents - drucker.MARGIN * rest, 1))
            if least.min() >= 0:
                best = min(best, float(np.sum((matrix @ moduli - soft) ** 2)))
    own = float(np.sum((matrix @ held.moduli - soft) ** 2))
    assert own <= best * 1.0001


@pytest.mark.parametrize(("phi", "least"), [(0.0, 0.93), (0.5, 0.93), (0.8, 0.88)])
def test_errors_cover_the_truth(phi: float, least: float) -> None:
    # noise that is correlated or not: the truth lies within two errors as often as they say
    truth = Material("yeoh", {"c1": 0.09, "c2": 0.009})
    stretch = np.linspace(1.02, 2.0, 42)
    exact = uniaxial_stress(truth, stretch)
    source, hits, count = np.random.default_rng(11), 0, 150
    for _ in range(count):
        white = source.standard_normal(len(stretch))
        noise = white.copy()
        for i in range(1, len(noise)):
            noise[i] = phi * noise[i - 1] + np.sqrt(1 - phi**2) * white[i]
        found = fit_law(
            "yeoh-2", [Measurement(UNIAXIAL, stretch, exact + 0.01 * exact[-1] * noise)]
        )
        off = (found.values - np.array([0.09, 0.009])) / np.sqrt(np.diag(found.covariance))
        hits += int((np.abs(off) < 1.96).sum())
    assert hits / (2 * count) >= least


def test_resampled_fits_spread_as_the_covariance_says() -> None:
    found = fit_law("yeoh-2", [published("dragon-skin-30.csv", "uniaxial", 2.0)])
    source = np.random.default_rng(3)
    draws = np.array([found.resampled(source) for _ in range(300)])
    assert np.std(draws, axis=0) == pytest.approx(np.sqrt(np.diag(found.covariance)), rel=0.15)
    assert np.mean(draws, axis=0) == pytest.approx(found.values, rel=0.01)


def test_more_points_of_one_curve_say_no_more() -> None:
    test = published("dragon-skin-30.csv", "uniaxial", 2.0)
    errors = []
    for count in (50, 500, 5000):
        stretch = np.linspace(test.stretch[0], test.stretch[-1], count)
        curve = Measurement(UNIAXIAL, stretch, np.interp(stretch, test.stretch, test.stress))
        errors.append(np.sqrt(np.diag(fit_law("yeoh-2", [curve]).covariance)))
    assert errors[1] == pytest.approx(errors[0], rel=0.15)
    assert errors[2] == pytest.approx(errors[1], rel=0.05)


def test_terms_that_cancel_are_known() -> None:
    # two terms of Ogden's become the derivative of one by its exponent
    found = fit_law("ogden-2", [published("dragon-skin-30.csv", "uniaxial", 9.0)])
    assert found.cancelling > 1000
    assert found.loose
    plain = fit_law("ogden-1", [published("dragon-skin-30.csv", "uniaxial", 9.0)])
    assert plain.cancelling == pytest.approx(1.0)
    assert not plain.loose


@pytest.mark.parametrize("start", [[1.5, -3.0], [-3.0, 1.5]])
def test_terms_that_are_alike_stand_in_order(start: list[float]) -> None:
    known = RUBBERS["ogden"]
    tests = measured(known, UNIAXIAL, EQUIBIAXIAL)
    weights = [np.full(len(test.stress), 1 / test.stress.std()) for test in tests]
    found = search(Problem(form_of("ogden-2"), tests, weights, None), [np.array(start)])
    assert np.all(np.diff(np.abs(found.shape)) > 0)


def test_what_tests_do_not_settle_is_said() -> None:
    # a rubber without stiffening has no limit of Gent's
    found = fit_law("gent", measured(RUBBERS["neo-hooke"], UNIAXIAL))
    assert found.unsettled == ("jm",)
    assert found.parameters["mu"] == pytest.approx(0.3, rel=1e-3)


def test_a_law_of_ones_own_is_fitted() -> None:
    def energy(state: Deformation, scale: float, stiffening: float) -> object:
        return scale * (state.exp(stiffening * (state.i1 - 3)) - 1)

    own = Law(
        "fung",
        energy,  # Demiray's exponential
        (
            Parameter("scale", "a", allowed="above zero"),
            Parameter("stiffening", "b", unit="1", allowed="above zero", elsewhere=0.0),
        ),
    )
    stretch = np.linspace(0.8, 2.0, 30)
    i1 = stretch**2 + 2 / stretch
    stress = 2 * (stretch - stretch**-2.0) * 0.3 * 0.2 * np.exp(0.2 * (i1 - 3))
    found = fit_law(form_of("fung", {"fung": own}), [Measurement(UNIAXIAL, stretch, stress)])
    assert found.parameters == pytest.approx({"scale": 0.3, "stiffening": 0.2}, rel=1e-6)


def test_refusals() -> None:
    test = measured(RUBBERS["yeoh"], UNIAXIAL)
    for name in ("yeo", "yeoh-4", "yeoh-0", "gent-2", "ogden-4"):
        with pytest.raises(ValueError, match=r"expected one of yeoh \(yeoh-1 to -3\), neo-hooke"):
            fit_law(name, test)
    few = Measurement(UNIAXIAL, np.array([1.0, 1.2, 1.4]), np.array([0.0, 0.1, 0.2]))
    with pytest.raises(ValueError, match="2 parameters, expected more points"):
        fit_law("yeoh-2", [few])
    with pytest.raises(ValueError, match="all stresses are zero"):
        fit_law("yeoh-1", [Measurement(UNIAXIAL, few.stretch, 0 * few.stress)])


def test_a_law_that_is_not_linear_in_its_moduli_is_refused() -> None:
    def energy(state: Deformation, a: float, b: float) -> object:
        return (a * b) ** 0.5 * (state.i1 - 3) + (a - a) * state.i2

    odd = Law("odd", energy, (Parameter("a", "one"), Parameter("b", "other")))
    with pytest.raises(ValueError, match="not linear in its moduli"):
        form_of("odd", {"odd": odd})
