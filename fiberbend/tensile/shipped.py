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


def file_of(path: Path) -> Path:
    """A user's file; where there is none, the test of this name that comes with the program.

    Args:
        path: a path; a name without a folder and an ending may be one of `names`.
    """
    shipped = path.parent == Path() and not path.suffix and path.name in names()
    return folder() / f"{path.name}.csv" if shipped and not path.exists() else path
