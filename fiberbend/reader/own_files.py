"""Materials of files that a case names: written into the case before it is checked.

`wall: my-rubber.yaml` is replaced by what the file says, `data: tensile.csv` by the coefficients of
the law that is fitted to it. What a run keeps is complete by itself and says where it comes from.
"""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from fiberbend.effects.table import EFFECTS
from fiberbend.reader.yaml_file import read_yaml
from fiberbend.schema.paths import value_at
from fiberbend.schema.problems import CaseError, Problem, found
from fiberbend.schema.units import parse

_ENDINGS = (".yaml", ".yml")
_PARTS = ("wall", "floor", "sheath", "layer")


@dataclasses.dataclass(frozen=True)
class Place:
    """Where a case may name a file.

    Attributes:
        path: dotted path.
        holder: the mapping that has the value.
        key: of the value.
        written: key of the value in what the file says; empty: all of it stands for the value.
    """

    path: str
    holder: dict[str, Any]
    key: str
    written: str = ""

    @property
    def value(self) -> Any:
        """What the case says there."""
        return self.holder.get(self.key)


@dataclasses.dataclass(frozen=True)
class Inlined:
    """A case without names of files.

    Attributes:
        data: the case, not yet checked.
        files: by the path of what came from one: its name, and the lines of its values.
    """

    data: Mapping[str, Any]
    files: Mapping[str, tuple[str, Mapping[str, int]]]

    def located(self, problem: Problem) -> Problem:
        """A problem of a value of a file, as one of that file."""
        for path, (name, lines) in self.files.items():
            if problem.path == path or problem.path.startswith(f"{path}."):
                own = problem.path.removeprefix(path).removeprefix(".")
                line = lines.get(own)
                where = name if line is None else f"{name}, line {line}"
                return dataclasses.replace(problem, text=f"{where}: {problem.text}")
        return problem


def root_paths(data: dict[str, Any], folder: Path) -> None:
    """Make the files that a case names independent of where it lies.

    Args:
        data: the case, not yet checked; changed in place.
        folder: that of the case file.
    """
    for place in places(data):
        if _names_file(place.value):
            place.holder[place.key] = str(folder.resolve() / place.value)
        elif isinstance(place.value, dict):
            _root_tests(place.value, folder)
    pressure = _pressure_over_time(data)
    if isinstance(pressure.get("file"), str | Path):
        pressure["file"] = str(folder.resolve() / pressure["file"])
    output = data.get("output")
    if not isinstance(output, dict):
        return
    measured = output.get("measured")
    if isinstance(measured, str):
        output["measured"] = str(folder.resolve() / measured)
    elif isinstance(measured, dict) and isinstance(measured.get("file"), str):
        measured["file"] = str(folder.resolve() / measured["file"])


def rooted_value(path: str, value: Any, folder: Path) -> Any:
    """The value of a change, with the files that it names seen from a folder.

    Args:
        path: of the change in a case.
        value: as YAML gives it.
        folder: from which files are seen.
    """
    # which entry of a list it is does not matter here, and no list is made to have it
    keys = ["0" if key.isdecimal() else key for key in path.split(".")]
    data = copy.deepcopy(value)
    for key in reversed(keys):
        data = [data] if key == "0" else {key: data}
    if not isinstance(data, dict):
        return value
    root_paths(data, folder)
    return value_at(data, ".".join(keys))


def rooted_values(path: str, values: Any, folder: Path) -> Any:
    """Several values of a change, likewise; what is no list of them stays as it is."""
    if not isinstance(values, list | tuple):
        return values
    return [rooted_value(path, value, folder) for value in values]


def inlined(data: Mapping[str, Any]) -> Inlined:
    """A case with its files written into it.

    Args:
        data: the case, not yet checked; stays as it is.

    Raises:
        CaseError: everything that is wrong with the files themselves.
    """
    timed = "file" in _pressure_over_time(data)
    if not timed and not any(_asks(place.value) for place in places(data)):
        return Inlined(data, {})
    whole = copy.deepcopy(dict(data))
    files: dict[str, tuple[str, Mapping[str, int]]] = {}
    problems: list[Problem] = []
    if timed:
        try:
            _write_points(_pressure_over_time(whole))
        except ValueError as error:
            problems.append(Problem("time.pressure.file", str(error)))
    weighs = _weighs(whole)
    for place in list(places(whole)):
        try:
            if _names_file(place.value):
                files |= _write(place, weighs)
            if isinstance(place.value, dict) and place.value.get("data") is not None:
                place.holder[place.key] = _fitted(place.value, place.path)
        except CaseError as error:
            problems += error.problems
    if problems:
        raise CaseError(problems)
    return Inlined(whole, files)


def places(data: Mapping[str, Any]) -> Iterator[Place]:
    """Every place of a case that may name a file of a material, a thread or a fabric."""
    yield from _parts(data.get("materials"), "materials", _PARTS)
    for number, entry in enumerate(_list(data.get("effects"))):
        for name, effect in entry.items() if isinstance(entry, dict) else ():
            yield from _effect(name, effect, f"effects.{number}.{name}")
    for number, zone in enumerate(_list(data.get("zones"))):
        if not isinstance(zone, dict):
            continue
        path = f"zones.{number}"
        yield from _parts(zone, path, ("floor", "layer"))
        yield from _effect("winding", zone.get("winding"), f"{path}.winding")
        strips = zone.get("strip")
        if isinstance(strips, dict):
            yield from _effect("strip", strips, f"{path}.strip")
        for place, strip in enumerate(_list(strips)):
            yield from _effect("strip", strip, f"{path}.strip.{place}")


def _parts(holder: Any, path: str, keys: tuple[str, ...]) -> Iterator[Place]:
    for key in keys if isinstance(holder, dict) else ():
        if key in holder:
            yield Place(f"{path}.{key}", holder, key)


def _effect(name: str, effect: Any, path: str) -> Iterator[Place]:
    if not isinstance(effect, dict):
        return
    if name == "winding":
        yield from _parts(effect, path, ("fiber",))
        for number, family in enumerate(_list(effect.get("families"))):
            yield from _parts(family, f"{path}.families.{number}", ("fiber",))
    elif name == "strip" and "fabric" in effect:
        yield Place(f"{path}.fabric", effect, "fabric", path)


def _pressure_over_time(data: Mapping[str, Any]) -> dict[str, Any]:
    """What a case says of its pressure over time; empty where that is nothing."""
    time = data.get("time")
    pressure = time.get("pressure") if isinstance(time, dict) else None
    return pressure if isinstance(pressure, dict) else {}


def _write_points(pressure: dict[str, Any]) -> None:
    """Write the rows of a file of pressures in the place of its name.

    Raises:
        ValueError: what is wrong with the file.
    """
    from fiberbend.case.timed.file import points

    if isinstance(pressure["file"], str | Path) and pressure.keys() == {"file"}:
        # whatever else there is, is said by the check of the case
        pressure["points"] = points(Path(pressure.pop("file")))


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []


def _names_file(value: Any) -> bool:
    return isinstance(value, str | Path) and str(value).endswith(_ENDINGS)


def _asks(value: Any) -> bool:
    return _names_file(value) or (isinstance(value, dict) and value.get("data") is not None)


def _root_tests(value: dict[str, Any], folder: Path) -> None:
    """Make the files of tests of a material independent of where the file lies that names them."""
    from fiberbend.tensile.shipped import file_of

    data = value.get("data")
    if isinstance(data, str | Path):
        value["data"] = str(file_of(Path(data), folder.resolve()))
    elif isinstance(data, dict):
        for way, file in data.items():
            if isinstance(file, str | Path):
                data[way] = str(file_of(Path(file), folder.resolve()))


def _weighs(data: Mapping[str, Any]) -> bool:
    """Whether an effect of a case, or its motion, needs densities."""
    if data.get("time") is not None:
        return True
    names = {name for name, effect in EFFECTS.items() if effect.needs_density}
    entries = (e for e in _list(data.get("effects")) if isinstance(e, dict))
    return any(not names.isdisjoint(entry) for entry in entries)


def _write(place: Place, weighs: bool) -> dict[str, tuple[str, Mapping[str, int]]]:
    """Write what a file says in the place of its name.

    Args:
        place: that names it.
        weighs: densities count.

    Returns:
        As `Inlined.files`.

    Raises:
        CaseError: it cannot be read, or names another file in its turn.
    """
    path = Path(place.value)
    try:
        content = read_yaml(path)
    except CaseError as error:
        wrong = (f"{p.path.replace(str(path), path.name)}: {p.text}" for p in error.problems)
        # its reader speaks of cases
        texts = [text.replace("a case file", "a file of a material") for text in wrong]
        raise CaseError(
            Problem(place.path, text.replace("expected a case", "expected a material"))
            for text in texts
        ) from None
    said = content.data
    if _names_file(said.get("name")):
        text = f"{path.name}: {found(said['name'])}, expected no file within a file"
        raise CaseError([Problem(place.path, text)])
    _root_tests(said, path.parent)
    if not weighs and not _refused(said.get("density")):
        # a rubber has its density also where nothing weighs it
        said.pop("density", None)
    known = said.get("source")
    if known is not None or "name" not in said:
        # a name has its own source
        said["source"] = f"{path.name}: {known}" if isinstance(known, str) else path.name
    if place.written:
        # a fabric's numbers stand beside what the strip says of its place
        del place.holder[place.key]
        files: dict[str, tuple[str, Mapping[str, int]]] = {}
        for key, value in said.items():
            if key in place.holder:
                text = f"no effect beside fabric {path.name}, expected no value"
                raise CaseError([Problem(f"{place.written}.{key}", text)])
            place.holder[key] = value
            lines = {"": content.lines[key]} if key in content.lines else {}
            files[f"{place.written}.{key}"] = (path.name, lines)
        return files
    place.holder[place.key] = said
    return {place.path: (path.name, content.lines)}


def _refused(density: Any) -> bool:
    """Whether a density is none."""
    try:
        return parse(density, "density") < 0
    except ValueError:
        return True


def _fitted(value: dict[str, Any], path: str) -> dict[str, Any]:
    """A material with coefficients in place of the tests that they are fitted to."""
    from fiberbend.reader.own_tests import fitted

    return fitted(value, path)
