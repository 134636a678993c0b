"""Soft fiber-reinforced bending actuators: cases, runs and their results.

import fiberbend

r = fiberbend.run("finger.yaml", settings={"actuator.wall": "3 mm"})
r.at(pressure="100 kPa")["angle_deg"], r.frame, r.mesh("last")
fiberbend.load("runs/finger"), fiberbend.plan("finger.yaml")
"""

from __future__ import annotations

import os
import sys

# `python -m fiberbend` puts the working folder first in the path: before anything else is imported
# it is taken out, or a file yaml.py beside a case would be yaml.
if (
    sys.argv[:1] == ["-m"]
    and not sys.flags.safe_path
    and sys.path[:1] != [os.path.dirname(os.path.dirname(__file__))]
):
    del sys.path[0]

# Nothing slow here: until fiberbend.__main__ takes the signals, Ctrl-C is a traceback.
_PLACES = {
    "run": "fiberbend.api.calls",
    "load": "fiberbend.api.calls",
    "plan": "fiberbend.api.calls",
    "validate": "fiberbend.api.calls",
    "sweep": "fiberbend.api.calls",
    "trial": "fiberbend.api.trial",
    "Case": "fiberbend.case.case",
    "CaseError": "fiberbend.schema.problems",
    "Result": "fiberbend.api.result",
    "Style": "fiberbend.drawing.style",
    "Sweep": "fiberbend.api.sweep",
    "Trial": "fiberbend.api.trial",
    "__version__": "fiberbend.version",
}
"""Public names, and the modules that are imported when they are asked for."""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from fiberbend.api.calls import load as load
    from fiberbend.api.calls import plan as plan
    from fiberbend.api.calls import run as run
    from fiberbend.api.calls import sweep as sweep
    from fiberbend.api.calls import validate as validate
    from fiberbend.api.result import Result as Result
    from fiberbend.api.sweep import Sweep as Sweep
    from fiberbend.api.trial import Trial as Trial
    from fiberbend.api.trial import trial as trial
    from fiberbend.case.case import Case as Case
    from fiberbend.drawing.style import Style as Style
    from fiberbend.schema.problems import CaseError as CaseError
    from fiberbend.version import __version__ as __version__

__all__ = [
    "Case",
    "CaseError",
    "Result",
    "Style",
    "Sweep",
    "Trial",
    "__version__",
    "load",
    "plan",
    "run",
    "sweep",
    "trial",
    "validate",
]


class _Package(type(sys)):  # type: ignore[misc]
    """This module, in which the folders plan/, sweep/ and trial/ do not hide the functions."""

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in __all__ and isinstance(value, type(sys))):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package


def __getattr__(name: str) -> object:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    from fiberbend.process import own

    if line := own.shadowed():
        raise ImportError(line)
    value: object = getattr(importlib.import_module(_PLACES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
