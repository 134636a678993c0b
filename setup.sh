#!/usr/bin/env bash
# Installs Debian's FEniCSx and the Python environment .venv; does nothing when both are in place.
set -euo pipefail
cd "$(dirname "$0")"

PYTHON=/usr/bin/python3
STAMP=.venv/setup.stamp
mapfile -t packages < apt-packages.txt
# The folder is part of the key: a moved .venv has dead paths inside.
key=$({ pwd; cat pyproject.toml constraints.txt apt-packages.txt setup.sh; } | sha256sum)

missing_packages() {
    comm -23 <(printf '%s\n' "${packages[@]}" | sort) \
        <(dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' 2>/dev/null | sed -n 's/^ii //p' | sort -u)
}

fail() {
    printf 'setup: %s\n' "$1" >&2
    exit 1
}

command -v dpkg-query >/dev/null || fail "this is not a Debian machine; Debian 12 is what is supported."
missing=$(missing_packages)
if [[ -z $missing && -x .venv/bin/fiberbend && -f $STAMP && $(<"$STAMP") == "$key" ]]; then
    exit 0
fi

if [[ -n $missing ]]; then
    as_root=()
    if [[ $(id -u) -ne 0 ]]; then
        if ! command -v sudo >/dev/null || ! { sudo -n true 2>/dev/null || [[ -t 0 ]]; }; then
            fail "these Debian packages are missing, and installing them needs root or sudo. Let an
administrator run:  apt-get install --no-install-recommends $(echo $missing)"
        fi
        as_root=(sudo)
    fi
    echo "setup: installing Debian packages:" $missing
    # A dpkg that asks, or that waits for the disk after every file, has no place here.
    apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o Dpkg::Use-Pty=0)
    "${apt[@]}" update || fail "apt-get update failed; is the network up?"
    "${apt[@]}" install -y --no-install-recommends \
        -o Dpkg::Options::=--force-unsafe-io $missing ||
        fail "apt-get could not install: $(echo $missing)"
fi

echo "setup: installing Python packages into .venv"
if ! grep -qsF "$PWD/.venv" .venv/pyvenv.cfg || ! .venv/bin/python -c '' 2>/dev/null; then
    $PYTHON -m venv --clear --system-site-packages .venv
fi
.venv/bin/python -m pip install -qq --disable-pip-version-check --no-compile \
    --constraint constraints.txt --editable '.[dev]' ||
    fail "pip could not install the Python packages."
.venv/bin/python - <<'CHECK' || fail "pip brought its own numpy or scipy; dolfinx needs Debian's."
import numpy, scipy, sys
sys.exit(any(".venv" in module.__file__ for module in (numpy, scipy)))
CHECK
# Bytes of what every run imports; all of the packages would take longer than they ever save.
env -u PYTHONDONTWRITEBYTECODE .venv/bin/python -c \
    'import fiberbend.cli, fiberbend.reader, matplotlib.pyplot, pyvista, rich.progress' ||
    fail "the installed packages do not import."
printf '%s\n' "$key" > "$STAMP"
echo "setup: done"
