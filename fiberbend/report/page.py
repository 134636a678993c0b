"""What every report shares: one HTML file that needs nothing else, from templates by jinja2.

jinja2 is imported where it is used: a run without a report does without it.
"""

from __future__ import annotations

import dataclasses
import functools
import os
from importlib import resources
from pathlib import Path
from typing import Any

from fiberbend.report.packing import base64_of

_TYPES = {
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".gif": "image/gif",
    ".csv": "text/csv",
    ".json": "application/json",
    ".yaml": "application/yaml",
    ".md": "text/markdown",
}


@dataclasses.dataclass(frozen=True)
class Download:
    """A file that the page contains, or that lies beside it.

    Attributes:
        name: path within the folder.
        address: where the browser finds it: the content itself, or a relative path.
        size: of the file, in words.
        inside: the page contains it.
    """

    name: str
    address: str
    size: str
    inside: bool


@dataclasses.dataclass(frozen=True)
class Picture:
    """A picture that the page contains.

    Attributes:
        address: its content.
        text: what it shows.
        name: of its file, empty for one that is in no file.
        inside: the page contains it; else it is a link.
    """

    address: str
    text: str
    name: str = ""
    inside: bool = True


def render(template: str, **context: Any) -> str:
    """A page.

    Args:
        template: name of its file in `templates`.
        context: what the template names; text is escaped.

    Raises:
        jinja2.UndefinedError: it names what is not given.
    """
    page: str = _environment().get_template(template).render(**context)
    return page


def data_address(content: bytes, name: str) -> str:
    """Content as an address of itself; `name` gives the type by its ending."""
    kind = _TYPES.get(Path(name).suffix, "application/octet-stream")
    return f"data:{kind};base64,{base64_of(content)}"


def is_picture(path: Path) -> bool:
    """Whether a page can show a file as a picture: films are links."""
    return _TYPES.get(path.suffix, "").startswith("image/")


def picture(path: Path, text: str) -> Picture:
    """The picture of a file."""
    return Picture(data_address(path.read_bytes(), path.name), text, path.name)


def inside(path: Path, folder: Path) -> Download:
    """A file as a part of the page."""
    content = path.read_bytes()
    name = path.relative_to(folder).as_posix()
    return Download(name, data_address(content, path.name), _size(len(content)), True)


def beside(path: Path, folder: Path, links: str = "") -> Download:
    """A file that is too large for the page; `links` as of `link`."""
    name = path.relative_to(folder).as_posix()
    return Download(name, link(path, folder, links), _size(path.stat().st_size), False)


def links_to(folder: Path | None, page: Path) -> str:
    """What leads from a page to a folder, "runs/finger/"; empty without one, and in it."""
    if folder is None or folder.resolve() == page.resolve().parent:
        return ""
    return Path(os.path.relpath(folder.resolve(), page.resolve().parent)).as_posix() + "/"


def link(path: Path, folder: Path, links: str = "") -> str:
    """Where a browser finds a file of a folder from the page.

    Args:
        path: the file.
        folder: the folder.
        links: what leads from the page to the folder; empty where the page is in it.
    """
    from urllib.parse import quote

    # a name with a colon at its beginning would be another protocol
    return quote(f"{links or './'}{path.relative_to(folder).as_posix()}")


def asset(name: str) -> str:
    """A text of `assets`."""
    return (resources.files("fiberbend.report") / "assets" / name).read_text(encoding="utf-8")


@functools.cache
def citation() -> dict[str, Any]:
    """CITATION.cff."""
    import yaml

    content: dict[str, Any] = yaml.safe_load(asset("CITATION.cff"))
    return content


@functools.cache
def _environment() -> Any:
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("fiberbend.report", "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["asset"] = asset
    return environment


def _size(count: int) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1e5 else f"{max(1, round(count / 1e3))} kB"
