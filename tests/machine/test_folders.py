"""Folders of kernels and temporary files: what is refused, what is taken instead, what is said."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

import pytest

from machine import folders
from machine.folders import MachineError, cache_root, make_private, refusal, settle


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Homes and temporary folders of this test alone."""
    home, temporary = tmp_path / "home", tmp_path / "temporary"
    for folder in (home, temporary):
        folder.mkdir(mode=0o700)
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("TMPDIR", str(temporary))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.delenv("MPLCONFIGDIR", raising=False)
    monkeypatch.setattr(tempfile, "tempdir", None)
    folders._cache_root.cache_clear()


def test_the_cache_is_where_the_variable_or_the_home_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert cache_root() == folders.Chosen(tmp_path / "home/.cache/fiberbend")
    monkeypatch.setenv("XDG_CACHE_HOME", "not/absolute")
    assert cache_root() == folders.Chosen(tmp_path / "home/.cache/fiberbend")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "own"))
    assert cache_root() == folders.Chosen(tmp_path / "own/fiberbend")
    assert not (tmp_path / "own").exists(), "asking makes nothing"
    make_private(cache_root().path)
    for made in ("own", "own/fiberbend"):
        assert stat.S_IMODE((tmp_path / made).stat().st_mode) == 0o700
    assert refusal(cache_root().path) == ""


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o720])
def test_a_cache_that_others_can_write_is_not_used(tmp_path: Path, mode: int) -> None:
    root = tmp_path / "home/.cache/fiberbend"
    root.mkdir(parents=True)
    root.chmod(mode)
    chosen = cache_root()
    assert chosen.path == tmp_path / f"temporary/fiberbend-{os.geteuid()}"
    assert chosen.remark == (
        f"{root} is not used for compiled kernels: others can write it; {chosen.path} is taken, "
        "set XDG_CACHE_HOME to choose another"
    )


def test_what_lies_in_a_folder_of_all_is_not_used(tmp_path: Path) -> None:
    public = tmp_path / "public"
    public.mkdir()
    public.chmod(0o777)
    assert refusal(public / "fiberbend") == f"others can write {public}"
    public.chmod(0o1777)
    assert refusal(public / "fiberbend") == ""
    (public / "fiberbend").mkdir(mode=0o700)
    assert refusal(public / "fiberbend") == ""


def test_a_cache_of_another_user_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = tmp_path / "home/.cache/fiberbend"
    root.mkdir(parents=True, mode=0o700)
    link = tmp_path / "link"
    link.symlink_to(root)
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    assert refusal(root) == refusal(link) == "another user owns it"
    assert "another user owns it" in cache_root().remark


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert refusal(tmp_path / "file") == "it is no folder"
    assert refusal(tmp_path / "file" / "fiberbend") == "it cannot be written"
    with pytest.raises(MachineError, match=r"file.*set XDG_CACHE_HOME to another folder"):
        make_private(tmp_path / "file" / "fiberbend")


def read_only(*roots: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let folders refuse to be written, to root too."""
    access = os.access

    def checked(path: Path, mode: int) -> bool:
        inside = any(Path(path).is_relative_to(root) for root in roots)
        return access(path, mode) and not (mode & os.W_OK and inside)

    monkeypatch.setattr(os, "access", checked)


def test_where_nothing_can_be_written_the_variable_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read_only(tmp_path, monkeypatch=monkeypatch)
    with pytest.raises(MachineError) as error:
        cache_root()
    assert str(error.value).endswith("set XDG_CACHE_HOME to a folder that only you can write")
    assert str(error.value).count("it cannot be written") == 2


def test_a_home_that_cannot_be_written_costs_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read_only(tmp_path / "home", monkeypatch=monkeypatch)
    assert settle() == []
    root = tmp_path / f"temporary/fiberbend-{os.geteuid()}"
    assert cache_root().path == root
    assert os.environ["MPLCONFIGDIR"] == str(root / "matplotlib")
    assert os.environ["HOME"] == str(tmp_path / "home")


def test_no_home_and_no_such_user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def nobody(_user: int) -> None:
        raise KeyError

    monkeypatch.delenv("HOME")
    monkeypatch.setattr("pwd.getpwuid", nobody)
    assert settle() == []
    assert os.environ["HOME"] == str(tmp_path / f"temporary/fiberbend-{os.geteuid()}")
    assert Path.home() == Path(os.environ["HOME"])


def test_a_missing_temporary_folder_is_replaced_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path / "none"))
    (line,) = settle()
    assert line.startswith(f"TMPDIR={tmp_path / 'none'} cannot be written, ")
    assert Path(os.environ["TMPDIR"]).is_dir()
    assert settle() == []


def test_no_temporary_folder_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    def none() -> str:
        raise FileNotFoundError

    monkeypatch.setattr(tempfile, "gettempdir", none)
    with pytest.raises(MachineError, match="set TMPDIR to one that you can write"):
        settle()
