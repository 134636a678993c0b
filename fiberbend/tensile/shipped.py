"""Tests that come with the program, by their names."""

from __future__ import annotations

from pathlib import Path


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
