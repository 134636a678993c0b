"""Coefficients of a material of a case from the tests that it names."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fiberbend.case.materials import MaterialSpec, TestFiles
from fiberbend.schema.paths import keys
from fiberbend.schema.problems import CaseError, Problem, found
from fiberbend.schema.units import show
from materials.laws.table import LAWS

if TYPE_CHECKING:
    from fiberbend.tensile.reading import ModeName

_WAYS = tuple(keys(TestFiles))
_FITTED = ("data", "law", "upto")
_BESIDE = ("density", "bulk", "source")
_OPTION = re.compile(r"(?<!\w)--[a-z]")


def fitted(value: Mapping[str, Any], path: str) -> dict[str, Any]:
    """A material with a law's coefficients in place of its tests.

    Args:
        value: what the case says, with `data`; files are independent of where the case lies.
        path: of the material in the case.

    Raises:
        CaseError: everything that is wrong with it, or that no numbers fit.
    """
    problems = list(_wrong(value, path))
    if problems:
        raise CaseError(problems)
    from fiberbend.tensile.reading import Wanted, limit, read_test
    from fiberbend.tensile.shipped import file_of
    from materials.fit.fit import fit_law

    upto = value.get("upto")
    try:
        most = None if upto is None else limit(upto if isinstance(upto, str) else f"stretch {upto}")
    except ValueError as error:
        raise CaseError([Problem(f"{path}.upto", f"{found(upto)}, {error}")]) from None
    data = value["data"]
    files: dict[ModeName, str] = {"uniaxial": data} if isinstance(data, str) else data
    tests = []
    for way, file in files.items():
        try:
            tests.append(read_test(file_of(Path(file)), way, Wanted(most=most)).measurement)
        except CaseError as error:
            name = Path(file).name
            problems += (
                Problem(f"{path}.data", _of_case(f"{name}: {p.text}")) for p in error.problems
            )
    if problems:
        raise CaseError(problems)
    try:
        fit = fit_law(value["law"], tests)
        material = fit.material
    except ValueError as error:
        raise CaseError([Problem(f"{path}.law", str(error))]) from None
    names = ", ".join(test.name for test in tests)
    least = min(1.0, *(float(test.stretch.min()) for test in tests))
    greatest = max(1.0, *(float(test.stretch.max()) for test in tests))
    said = (
        f"{fit.form.name} fitted to {names} from a stretch of {least:.4g} to {greatest:.4g}, rms "
        f"{100 * fit.rms:.2g} % of the greatest stress"
    )
    if fit.loose:
        said += "; its terms nearly cancel or their errors are ten times as great: take fewer terms"
    elif fit.unsettled:
        said += f"; the tests do not settle {', '.join(fit.unsettled)}"
    known = value.get("source")
    kept = {key: value[key] for key in ("density", "bulk") if key in value}
    return {
        "law": material.law,
        **dict(_numbers(material.law, fit.parameters)),
        **kept,
        "tested": [least, greatest],
        "source": f"{said}; {known}" if known else said,
    }


def _of_case(text: str) -> str:
    """What is wrong with a test, where options of the command that reads tests cannot be given."""
    if not _OPTION.search(text):
        return text
    return f"{text}: options of `fiberbend fit`, whose material file a case takes"


def _wrong(value: Mapping[str, Any], path: str) -> Iterator[Problem]:
    """What does not go with tests."""
    known = {*_FITTED, *_BESIDE}
    for key in value:
        if key not in known and key in keys(MaterialSpec):
            yield Problem(f"{path}.{key}", "no effect beside data, expected no value")
        elif key not in known:
            names = ", ".join((*_FITTED, *_BESIDE))
            yield Problem(f"{path}.{key}", f"unknown key, expected one of {names}")
    if not isinstance(value.get("law"), str):
        text = f"missing, expected a law to fit, such as yeoh or yeoh-2 ({', '.join(LAWS)})"
        yield Problem(f"{path}.law", text)
    if not isinstance(value.get("upto", 2.0), str | int | float):
        yield Problem(f"{path}.upto", f"{found(value['upto'])}, expected a stretch such as 2")
    data = value["data"]
    if isinstance(data, Mapping):
        for way, file in data.items():
            if way not in _WAYS:
                text = f"unknown key, expected one of {', '.join(_WAYS)}"
                yield Problem(f"{path}.data.{way}", text)
            elif not isinstance(file, str):
                yield Problem(f"{path}.data.{way}", f"{found(file)}, expected the name of a file")
        if not data:
            yield Problem(f"{path}.data", f"no test, expected one of {', '.join(_WAYS)}")
    elif not isinstance(data, str):
        text = f"expected the name of a file, or one for each of {', '.join(_WAYS)}"
        yield Problem(f"{path}.data", f"{found(data)}, {text}")


def _numbers(law: str, values: Mapping[str, float]) -> Iterator[tuple[str, Any]]:
    """Coefficients as a case gives them."""
    units = {parameter.name: parameter.unit for parameter in LAWS[law].parameters}
    for name, number in values.items():
        yield name, number if units[name] == "1" else show(number, "modulus")
