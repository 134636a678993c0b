"""Follows the Dockerfile in a bare Debian where there is no Docker, and uses what it has made.

    python3 bench/stacks/image.py build/image     # by `make test-image`, which makes that Debian

Every step is done as Docker does it: the same files, shell, variables and user, each in mounts of
its own. Then the program runs as that user, without a network. What is not tried is Docker itself.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from fnmatch import fnmatch
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
BASE = "debian:trixie-slim"
NETWORK = ("PIP_DEFAULT_TIMEOUT", "http_proxy", "https_proxy", "no_proxy")
"""What of this machine a step is told: how the network is reached."""
CERTIFICATES = "PIP_CERT"
PLACES = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
LOOPBACK = """
import fcntl, socket, struct
fcntl.ioctl(socket.socket(), 0x8914, struct.pack("16sH14s", b"lo", 0x41, b""))
"""
"""Puts the interface lo up (SIOCSIFFLAGS): it is what Docker leaves by `--network=none`."""
MOUNTS = """
mount -t proc proc "$0/proc"; mount --rbind /dev "$0/dev"; mount --rbind /sys "$0/sys"
exec chroot "$@"
"""
CHANGES = ("mesh.axial=6 mm", "output.at_angles=[90 deg]", "output.stop_at_angle=90 deg")
BODY = ("cases/free_bending.yaml", *(word for change in CHANGES for word in ("--set", change)))
USES: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("", ("version",)),
    ("", ("cases", "section", "free_bending")),
    ("", ("run", "cases/section.yaml")),
    ("mpirun", ("-n", "2", "fiberbend", "run", *BODY, "--out", "runs/body")),
)
"""What the image is used for: another entry point, or "", and words."""
LEFT = ("section/report.html", "section/history.csv", "body/history.csv", "body/pictures")
"""Under runs/."""


class Step(NamedTuple):
    """An instruction of a Dockerfile, and what stands behind it."""

    name: str
    text: str


def steps(text: str) -> list[Step]:
    """Instructions of a Dockerfile in their order."""
    lines = (line for line in text.splitlines() if not line.lstrip().startswith("#"))
    joined = "\n".join(lines).replace("\\\n", " ")
    found = [line.strip().split(maxsplit=1) for line in joined.splitlines() if line.strip()]
    return [Step(name, rest) for name, rest in found]


def context(root: Path, patterns: Sequence[str]) -> Iterator[Path]:
    """Files that Docker would be given, relative to the root.

    Args:
        root: folder of the Dockerfile.
        patterns: lines of .dockerignore: `*` first, then `!NAME` of what is given all the same, and
            `**/NAME` of what is not, wherever it lies.

    Raises:
        ValueError: another kind of pattern.
    """
    lines = [line for line in patterns if line and not line.startswith("#")]
    given = [line[1:] for line in lines if re.fullmatch(r"![\w.-]+", line)]
    never = [line[3:] for line in lines if re.fullmatch(r"\*\*/[\w.*-]+", line)]
    if lines[:1] != ["*"] or len(lines) != 1 + len(given) + len(never):
        raise ValueError(f".dockerignore: {lines}, expected *, !NAME and **/NAME")
    for name in given:
        if not (root / name).exists():
            raise ValueError(f".dockerignore: no {name}")
        inside = [root / name] if not (root / name).is_dir() else sorted((root / name).rglob("*"))
        for path in inside:
            part = path.relative_to(root)
            hidden = any(fnmatch(word, each) for word in part.parts for each in never)
            if not hidden and (path.is_symlink() or path.is_file()):
                yield part


class Image:
    """A Debian in which a Dockerfile is followed.

    Args:
        root: its folder.
        source: folder of the Dockerfile.
    """

    def __init__(self, root: Path, source: Path = ROOT) -> None:
        self.root, self.source = root, source
        self.folder, self.user = "/", "root"
        self.variables = {"PATH": PLACES}
        self.entry: list[str] = []

    def follow(self) -> None:
        """Do all steps.

        Raises:
            ValueError: an instruction that is not known here.
            subprocess.CalledProcessError: a command failed.
        """
        for name, text in steps((self.source / "Dockerfile").read_text(encoding="utf-8")):
            start = time.monotonic()
            known = {
                "FROM": self._from,
                "WORKDIR": self._workdir,
                "COPY": self._copy,
                "RUN": self._run,
                "ENV": self._env,
                "USER": self._user,
                "ENTRYPOINT": self._entrypoint,
                "CMD": lambda _: None,
            }
            if name not in known:
                raise ValueError(f"Dockerfile: {name}, expected one of {', '.join(known)}")
            known[name](text)
            print(f"{time.monotonic() - start:6.1f} s  {name} {text.split()[0]} …", flush=True)

    def _from(self, text: str) -> None:
        """As Docker's Debian has it, dpkg does not wait for the disk after every file."""
        if text != BASE:
            raise ValueError(f"Dockerfile: FROM {text}, but this is {BASE}")
        settings = self.inside("/etc/dpkg/dpkg.cfg.d")
        settings.mkdir(parents=True, exist_ok=True)
        (settings / "docker-apt-speedup").write_text("force-unsafe-io\n", encoding="utf-8")

    def _workdir(self, text: str) -> None:
        self.folder = text
        if not self.inside(text).is_dir():
            self.inside(text).mkdir(parents=True)

    def _copy(self, text: str) -> None:
        *names, target = text.split()
        patterns = (self.source / ".dockerignore").read_text(encoding="utf-8").splitlines()
        every = list(context(self.source, patterns))
        for name in names:
            chosen = [path for path in every if name in (".", str(path))]
            if not chosen:
                raise ValueError(f"Dockerfile: COPY {name}: .dockerignore leaves nothing of it")
            for path in chosen:
                place = self.inside(self.folder) / target / path
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(self.source / path, place, follow_symlinks=False)

    def _env(self, text: str) -> None:
        self.variables |= dict(word.split("=", 1) for word in shlex.split(text))

    def _user(self, text: str) -> None:
        self.user = text

    def _entrypoint(self, text: str) -> None:
        self.entry = json.loads(text)

    def _run(self, text: str) -> None:
        network = {name: os.environ[name] for name in NETWORK if name in os.environ}
        if CERTIFICATES in os.environ:
            network[CERTIFICATES] = "/etc/ssl/of-this-machine.crt"
            shutil.copyfile(os.environ[CERTIFICATES], self.inside(network[CERTIFICATES]))
        self.call(["/bin/sh", "-c", text], network)

    def inside(self, path: str) -> Path:
        """Where a path of the image is on this machine."""
        return self.root / path.lstrip("/")

    def home(self) -> str:
        """Of the user, as the image's own list of users has it."""
        users = self.inside("/etc/passwd").read_text(encoding="utf-8").splitlines()
        return next(line.split(":")[5] for line in users if line.startswith(f"{self.user}:"))

    def call(self, words: Sequence[str], more: dict[str, str], *, network: bool = True) -> None:
        """Run a command in the image, as its user and in its folder.

        Args:
            words: the command.
            more: variables beside the image's.
            network: whether the command has one.

        Raises:
            subprocess.CalledProcessError: it failed.
        """
        variables = {"HOME": self.home(), **self.variables, **more}
        own = ["unshare", "--mount", "--propagation", "private", *([] if network else ["--net"])]
        first = "" if network else shlex.join([sys.executable, "-c", LOOPBACK])
        who = f"--userspec={self.user}:{self.user}"
        shell = [*own, "bash", "-euc", first + MOUNTS, str(self.root), who, str(self.root)]
        given = [f"{name}={value}" for name, value in variables.items()]
        entered = ["env", "-i", *given, "sh", "-c", 'cd "$0" && exec "$@"', self.folder, *words]
        subprocess.run([*shell, *entered], check=True, stdin=subprocess.DEVNULL)

    def use(self) -> None:
        """Run what a user of the image runs, without a network.

        Raises:
            RuntimeError: something is not left behind, or is root's.
        """
        for other, words in USES:
            start = time.monotonic()
            self.call([*([other] if other else self.entry), *words], {}, network=False)
            print(f"{time.monotonic() - start:6.1f} s  {other or self.entry[0]} {' '.join(words)}")
        runs = self.inside(self.folder) / "runs"
        for name in LEFT:
            path = runs / name
            if not path.exists() or path.stat().st_uid == 0:
                raise RuntimeError(f"{path}: not there, or root's")


def main() -> None:
    """Follow the Dockerfile in the Debian that is named, and use it."""
    image = Image(Path(sys.argv[1]).resolve())
    image.follow()
    image.use()
    print(f"image: every step of Dockerfile and {len(USES)} uses of it without a network: well")


if __name__ == "__main__":
    main()
