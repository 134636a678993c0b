"""Tests that come with the program, by their names."""

from __future__ import annotations

from pathlib import Path

from fiberbend.schema.problems import meant


def folder() -> Path:
    """Where they are."""
    import materials

    return Path(materials.__file__).parent / "data"


def names() -> list[str]:
    """Their names, such as dragon-skin-30."""
    return sorted(path.stem for path in folder().glob("*.csv"))


def file_of(path: Path, seen_from: Path | None = None) -> Path:
    """A user's file; where there is none, the test of this name that comes with the program.

    Args:
        path: a path; a name without a folder and an ending may be one of `names`.
        seen_from: the folder that a path is relative to; the working folder by default.
    """
    own = path if seen_from is None else seen_from / path
    shipped = path.parent == Path() and not path.suffix and path.name in names()
    # a folder of results may have the name of a rubber
    return folder() / f"{path.name}.csv" if shipped and not own.is_file() else own


def near(path: Path) -> str:
    """The end of a message on a missing file: the nearest name of a test, where it may be meant."""
    if path.suffix not in ("", ".csv"):
        return ""
    # another number is another rubber
    alike = (name for name in names() if _digits(name) == _digits(path.stem))
    return meant(path.stem, alike)


def _digits(text: str) -> str:
    return "".join(filter(str.isdigit, text))
