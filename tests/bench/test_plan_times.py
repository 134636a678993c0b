"""The fit behind `fiberbend plan`, and the runs that it was made from."""

from __future__ import annotations

import json
from typing import Any

import pytest

from bench import plan_times
from bench.plan_times import KEPT, QUIET, ROOT, RUNS, Run, prices
from fiberbend.models.choice import meshed
from fiberbend.models.costs.price import AT_REST, FILE, Price
from fiberbend.plan.estimate import cost_of
from fiberbend.reader.reader import read_case
from machine.factors import LARGE

RECORDED: list[Run] = json.loads(KEPT.read_text(encoding="utf-8"))
LAW = Price(
    begin=(0.8, 1e-3),
    step=(0.02, 1e-6),
    residual=(1e-3, 4e-6),
    tangent=(2e-3, 5e-5),
    factor=(2e-9, 2.3),
    solve=(1e-8, 1.5),
    memory=(1e-4, 1.5),
    base_mb=100.0,
    iterations=(4.0, 6.0),
    factorisations=(0.5, 0.25),
)


def run_by(law: Price, layers: float, across: int, kind: str = "hexahedra") -> Run:
    """What a run takes that follows a law to the letter."""
    n, m = round(layers * across), round(layers * across / 35)
    large = n >= LARGE
    steps = 4
    iterations = steps * law.iterations[large]
    factors = iterations * law.factorisations[large]
    wide = n / layers

    def power(pair: tuple[float, float]) -> float:
        return pair[0] * layers * wide ** pair[1]

    phases = {
        "solve/residual": iterations * (law.residual[0] + law.residual[1] * m),
        "solve/tangent": (factors + AT_REST) * (law.tangent[0] + law.tangent[1] * m),
        "solve/factor": (factors + AT_REST) * power(law.factor),
        "solve/solve": iterations * power(law.solve),
    }
    phases["solve"] = sum(phases.values()) + steps * (law.step[0] + law.step[1] * n)
    seconds = phases["solve"] + law.begin[0] + law.begin[1] * m
    counts = {"elements": m, "unknowns": n, "layers": layers, "segments": 0, "steps": steps}
    return {
        **{"case": "", "model": "body", "kind": kind, **counts},
        **{"iterations": iterations, "factorisations": factors},
        "memory_MB": law.base_mb + power(law.memory),
        **{"seconds": seconds, "clock_s": seconds, "phases": phases},
    }


def test_a_fit_finds_the_law_of_its_runs() -> None:
    runs = [run_by(LAW, *size) for size in ((10, 300), (20, 900), (60, 700), (40, 2500))]
    found = Price(**prices(runs)["body hexahedra"])
    for run in runs:
        size = run["elements"], run["unknowns"], run["layers"]
        spent = found.start_seconds(*size) + run["steps"] * found.step_seconds(*size)
        assert spent == pytest.approx(run["seconds"], rel=0.05)
    assert found.factor[1] == pytest.approx(2.3, abs=0.02)
    assert found.iterations == pytest.approx([4.0, 6.0])
    assert found.factorisations == pytest.approx([0.5, 0.25])


def test_meshes_alike_across_take_the_power_of_the_others() -> None:
    hexahedra = [run_by(LAW, *size) for size in ((10, 300), (20, 900), (40, 2500))]
    alike = [run_by(LAW, layers, 700, "tetrahedra") for layers in (10, 20, 40)]
    made = prices([*hexahedra, *alike])
    assert made["body tetrahedra"]["factor"][1] == made["body hexahedra"]["factor"][1]
    assert made["body tetrahedra"]["factor"][0] == pytest.approx(2e-9, rel=0.2)


def test_a_touching_run_gives_no_price() -> None:
    touching = {"case": f"cases/{plan_times.TOUCHING}.yaml"}
    runs: list[dict[str, Any]] = [run_by(LAW, *size) for size in ((10, 300), (20, 900))]
    assert prices([*runs, touching]) == prices(runs)


def test_prices_are_those_of_the_recorded_runs() -> None:
    assert [(run["case"], tuple(run["changes"])) for run in RECORDED] == list(RUNS)
    kept, made = json.loads(FILE.read_text(encoding="utf-8"))["prices"], prices(RECORDED)
    assert kept.keys() == made.keys()
    for name, entry in made.items():
        for key, value in entry.items():
            assert kept[name][key] == pytest.approx(value, rel=5e-3, abs=1e-9), (name, key)


@pytest.mark.parametrize(
    "run", RECORDED, ids=lambda run: " ".join([run["case"][6:-5], *run["changes"]])
)
def test_a_plan_is_near_what_was_measured(run: Run) -> None:
    case = read_case(ROOT / run["case"], [*QUIET, *run["changes"]])
    model = meshed(case)
    cost = cost_of(case, model, model.size(case))
    planned = cost.seconds()
    assert planned is not None
    assert 1 / 1.8 < planned / run["seconds"] < 1.8
    assert 1 / 1.5 < cost.memory_mb / run["memory_MB"] < 1.5
