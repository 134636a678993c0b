"""Named materials in Python and by the command."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

import fiberbend
from fiberbend import CaseError
from fiberbend.api.materials import lines, whole
from fiberbend.cli import main
from materials.named.table import ENTRIES, RUBBERS


def test_python_has_all_or_those_of_a_kind() -> None:
    every = fiberbend.materials()
    assert every.names == sorted(ENTRIES)
    threads = fiberbend.materials("thread")
    assert "kevlar" in threads.names
    assert {entry.kind for entry in threads} == {"thread"}
    assert "31,080 MPa at rest" in str(threads)
    assert "<td" in threads._repr_html_()
    with pytest.raises(CaseError, match='"threads", expected one of rubber, thread, fabric, paper'):
        fiberbend.materials("threads")


@pytest.mark.parametrize("name", ENTRIES)
def test_an_entry_says_all_that_was_asked_for(name: str) -> None:
    entry = ENTRIES[name]
    told = "\n".join(lines(entry))
    for part in (entry.source.text, entry.source.address, entry.licence, entry.tested, name):
        assert part in told
    rows = dict(whole(entry))
    assert {"numbers", "at rest", "density", "tests", "range", "source", "licence"} <= set(rows)
    if name in RUBBERS:
        assert all(f"{value:g}" in told for value in RUBBERS[name].coefficients.values())


def test_the_command_lists_and_shows(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["materials"]) == 0
    told = capsys.readouterr().out
    assert all(f"{name}  (" in told for name in ENTRIES)
    assert "sources disagree: dragon-skin-10-beam is 2 times as stiff at rest" in told
    assert all(len(line) <= 100 for line in told.splitlines())
    assert main(["materials", "--kind", "paper"]) == 0
    assert "dragon-skin-10" not in capsys.readouterr().out
    assert main(["materials", "--kind", "fabric"]) == 0
    assert "no fabric has a name so far" in capsys.readouterr().out
    assert main(["materials", "dragon-skin-10"]) == 0
    told = capsys.readouterr().out
    assert "yeoh: c1 = 0.02185 MPa" in told
    assert "materials: {wall: dragon-skin-10}" in told


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["dragon-skin"], 'name: "dragon-skin", expected one that'),
        (["--plot", "a.png"], "--plot: no effect without NAME"),
        (["kevlar", "--plot", "a.png"], "--plot: expected a rubber"),
        (["rtv615", "--plot", "a.gif"], "a.gif: expected a name that ends in .png"),
        (["rtv615", "--open"], "--open: no effect without --plot"),
        (["rtv615", "--kind", "thread"], "--kind: thread, but rtv615 is a rubber"),
    ],
)
def test_what_cannot_be_shown(
    words: list[str], text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["materials", *words]) == 1
    assert text in capsys.readouterr().err


@pytest.mark.parametrize("name", ["dragon-skin-10", "silicone-meunier", "rtv615", "combined-base"])
def test_the_picture_of_a_rubber(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / "pictures" / f"{name}.png"
    assert main(["materials", name, "--plot", str(target)]) == 0
    assert f"picture: {target}" in capsys.readouterr().out
    with Image.open(target) as picture:
        assert min(picture.size) > 300
        assert len(picture.convert("RGB").getcolors(1 << 20) or []) > 20
