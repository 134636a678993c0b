"""Every pair of effects in every model: both act, or the case is refused with a sentence.

What is ignored in silence is the worst answer of all: it looks like one.
"""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from fiberbend import run
from fiberbend.case.case import Case
from fiberbend.effects.table import EFFECTS
from fiberbend.models.choice import MODELS
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError

SETTINGS: dict[str, dict[str, Any]] = {
    "pressure": {"to": "4 kPa"},
    "winding": {"pattern": "double-helix", "pitch": "8 mm", "fiber": "kevlar"},
    "hoops": {},
    "gravity": {"direction": "-y"},
    "blocked-tip": {},
    "contact": {"plane": {"point": ["0 mm", "-0.1 mm", "0 mm"], "normal": [0, 1, 0]}},
    "straight": {},
    "hold": {"stretch": 1.05},
    "tip-load": {"force": ["0 N", "-20 mN", "0 N"]},
    "tip-mass": {"mass": "2 g"},
    "strip": {
        "at": {"angle": "60 deg"},
        "width": "3 mm",
        "thickness": "0.1 mm",
        "modulus": "200 MPa",
    },
}
"""One of each: a new effect is paired with all others once it has a line here."""
PAIRS = list(itertools.combinations(SETTINGS, 2))


def data(model: str, names: tuple[str, ...]) -> dict[str, Any]:
    """A short actuator with some effects, under pressure where none of them is a load."""
    effects = [{name: SETTINGS[name]} for name in names]
    if not any(EFFECTS[name].load for name in names):
        effects.insert(0, {"pressure": SETTINGS["pressure"]})
    soft, stiff = ({"law": "neo-hooke", "mu": f"{mu} MPa"} for mu in (0.3, 16))
    weight = {"density": "1.1 g/cm^3"} if "gravity" in names else {}
    return {
        "actuator": {"radius": "8 mm", "length": "40 mm", "wall": "2 mm", "floor": "2 mm"},
        "materials": {"wall": soft | weight, "floor": stiff | weight},
        "effects": effects,
        "model": model,
        "mesh": {"axial": "8 mm"} if model == "body" else {"section": 1},
        "output": {"pictures": False} if model == "analytic" else {"fields": False},
    }


def accepted(model: str, names: tuple[str, ...]) -> Case | None:
    """The case, or None where it is refused."""
    try:
        return parse_case(data(model, names))
    except CaseError:
        return None


def test_every_effect_is_paired() -> None:
    assert set(SETTINGS) == set(EFFECTS)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("pair", PAIRS, ids="+".join)
def test_a_refused_pair_is_told_why(pair: tuple[str, str], model: str) -> None:
    try:
        parse_case(data(model, pair))
    except CaseError as error:
        for line in str(error).splitlines():
            what, _, why = line.partition(": ")
            assert what.startswith("effects")
            # it names the model that has no room for it, or the effect that it contradicts
            assert f"model {model} " in why or any(f".{name} " in why for name in pair), line
            assert len(why.split()) > 8, line


def curves(case: Case) -> list[tuple[float, ...]]:
    """What a run answers."""
    result = run(case)
    assert result.status == "converged", result.reason
    names = ("pressure_kPa", "angle_deg", "chamber_mm3", "tip_force_N", "tip_y_mm", "tip_z_mm")
    return [tuple(row.get(name) or 0.0 for name in names) for row in result.rows]


def check_both_act(pair: tuple[str, str], model: str) -> None:
    """Without either of them the answer is another one, or there is none."""
    case = accepted(model, pair)
    if case is None:
        pytest.skip("refused")
    both = curves(case)
    loads = [name for name in pair if EFFECTS[name].load]
    for name in pair:
        others = tuple(other for other in pair if other != name)
        if loads == [name]:
            # without its load nothing moves
            assert any(abs(a - b) > 1e-6 for a, b in zip(both[0], both[-1], strict=True))
            continue
        alone = accepted(model, others)
        if alone is not None:
            one = curves(alone)[-1]
            assert both[-1] != pytest.approx(one, rel=1e-5, abs=1e-6), f"{name} does nothing"


CHEAP = [(pair, model) for model in ("analytic", "section", "cell") for pair in PAIRS]


@pytest.mark.parametrize(
    ("pair", "model"),
    [
        pytest.param(*item, id="+".join(item[0]) + f"-{item[1]}")
        for item in CHEAP
        if accepted(item[1], item[0])
    ],
)
def test_both_of_a_pair_act(pair: tuple[str, str], model: str) -> None:
    check_both_act(pair, model)


@pytest.mark.hard
@pytest.mark.parametrize("pair", PAIRS, ids="+".join)
def test_both_of_a_pair_act_on_a_body(pair: tuple[str, str]) -> None:
    check_both_act(pair, "body")
