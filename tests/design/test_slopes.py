"""Derivatives by the tangent of the section beside those of cases that are solved beside."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import yaml

from fiberbend.design.reading import read_design
from fiberbend.design.solving.models import Section, Slopes
from fiberbend.design.solving.tries import Tries
from tests.design.made_up import ROOT


class Beside(Section):
    """A section that gives no derivatives itself."""

    def slopes(self, *_: object) -> Slopes | None:
        """None: cases beside are solved."""
        return None


def test_a_field_of_an_effect_is_found_wherever_the_pressure_stands(tmp_path: Path) -> None:
    case = yaml.safe_load((ROOT / "cases" / "section.yaml").read_text(encoding="utf-8"))
    case["effects"] = case["effects"][::-1]
    case |= {"output": {}, "compare": []}
    file = {
        "case": case,
        "vary": {
            "effects.0.winding.pitch": {"from": "2 mm", "to": "6 mm"},
            "actuator.wall": {"from": "1 mm", "to": "3 mm"},
        },
        "targets": [
            {"angle": {"at": "60 kPa", "is": "90 deg"}},
            {"straight-moment": {"at": "60 kPa", "most": "200 N*mm"}},
            {"width": {"most": "30 mm"}},
        ],
    }
    path = tmp_path / "design.yaml"
    path.write_text(yaml.safe_dump(file), encoding="utf-8")
    design = read_design(path)
    found = []
    for model in (Section(1), Beside(1)):
        tries = Tries(design, model)
        found.append(tries.slopes((), (0.3, 0.6)))
        assert tries.counted.slopes == (not isinstance(model, Beside))
    own, beside = found
    assert own is not None
    assert beside is not None
    np.testing.assert_allclose(own, beside, rtol=5e-3, atol=1e-6)
    assert np.all(own[0] != 0)
