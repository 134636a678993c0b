"""Where numbers come from: commit, processor and BLAS, read without starting a process."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from machine import origin


def git(folder: Path, *arguments: str) -> str:
    names = ("GIT_AUTHOR_NAME", "GIT_AUTHOR_EMAIL", "GIT_COMMITTER_NAME", "GIT_COMMITTER_EMAIL")
    environment = os.environ | dict.fromkeys(names, "someone")
    command = ["git", "-c", "commit.gpgsign=false", *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
    return done.stdout.decode().strip()


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    folder = tmp_path / "source"
    folder.mkdir()
    git(folder, "init", "-q")
    git(folder, "commit", "-q", "--allow-empty", "-m", "first")
    return folder


def test_commit_of_a_branch_packed_detached_and_of_a_work_tree(
    repository: Path, tmp_path: Path
) -> None:
    first = git(repository, "rev-parse", "HEAD")
    assert origin.commit(repository) == first
    git(repository, "pack-refs", "--all")
    assert not list((repository / ".git" / "refs" / "heads").iterdir())
    assert origin.commit(repository) == first
    git(repository, "worktree", "add", "-q", str(tmp_path / "beside"), "-b", "other")
    git(tmp_path / "beside", "commit", "-q", "--allow-empty", "-m", "second")
    second = git(tmp_path / "beside", "rev-parse", "HEAD")
    assert origin.commit(tmp_path / "beside") == second != first
    git(repository, "checkout", "-q", "--detach", second)
    assert origin.commit(repository) == second


def test_what_is_no_repository_has_no_commit(tmp_path: Path) -> None:
    assert origin.commit(tmp_path) is None
    (tmp_path / ".git").mkdir()
    assert origin.commit(tmp_path) is None
    (tmp_path / ".git" / "HEAD").write_text("ref: refs/heads/main\n", encoding="utf-8")
    assert origin.commit(tmp_path) is None
    (tmp_path / ".git" / "HEAD").write_text("nonsense\n", encoding="utf-8")
    assert origin.commit(tmp_path) is None


def test_machine_and_blas() -> None:
    known = origin.machine()
    assert known["processor"]
    assert known["system"].startswith(os.uname().sysname)
    assert known["cores"] >= known["usable_cores"] >= 1
    assert np.dot([1.0], [1.0]) == 1
    found = origin.blas()
    assert found is not None
    if found["library"].startswith("OpenBLAS"):
        assert found["kernel"]
        assert found["threads"] >= 1
