#!/usr/bin/env bash
# Installs Debian's FEniCSx and the Python environment .venv; does nothing when both are in place.
set -euo pipefail
cd "$(dirname "$0")"

PYTHON=/usr/bin/python3
STAMP=.venv/setup.stamp
mapfile -t packages < apt-packages.txt
# The folder is part of the key: a moved .venv has dead paths inside.
inputs=(pyproject.toml requirements.txt constraints.txt apt-packages.txt setup.sh)
key=$({ pwd; cat "${inputs[@]}"; } | sha256sum)

missing_packages() {
    comm -23 <(printf '%s\n' "${packages[@]}" | sort) \
        <(dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' 2>/dev/null | sed -n 's/^ii //p' | sort -u)
}

fail() {
    printf 'setup: %s\n' "$1" >&2
    exit 1
}

apt() {
    # A dpkg that asks, or that waits for the disk after every file, has no place here.
    local options=(-q -y -o Dpkg::Use-Pty=0 -o Dpkg::Options::=--force-unsafe-io)
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get "${options[@]}" --no-install-recommends "$@" > "$log" 2>&1 ||
        { tail -n 20 "$log" >&2; return 1; }
}

pip() {
    .venv/bin/python -m pip install -qq --disable-pip-version-check --no-compile "$@"
}

command -v dpkg-query >/dev/null || fail "this is not a Debian machine; Debian 12 is what is supported."
missing=$(missing_packages)
if [[ -z $missing && -x .venv/bin/fiberbend && -f $STAMP && $(<"$STAMP") == "$key" ]]; then
    exit 0
fi

log=$(mktemp)
trap 'rm -f "$log"; kill $(jobs -p) 2>/dev/null || true' EXIT
as_root=()
if [[ -n $missing ]]; then
    if [[ $(id -u) -ne 0 ]]; then
        if ! command -v sudo >/dev/null || ! { sudo -n true 2>/dev/null || [[ -t 0 ]]; }; then
            fail "these Debian packages are missing, and installing them needs root or sudo. Let an
administrator run:  apt-get install --no-install-recommends $(echo $missing)"
        fi
        as_root=(sudo)
    fi
    echo "setup: installing Debian packages, some minutes:" $missing
    apt update || fail "apt-get update failed; is the network up?"
fi
if [[ $missing == *python3-venv* ]]; then
    apt install python3-venv || fail "apt-get could not install python3-venv."
fi

echo "setup: installing Python packages into .venv"
if ! grep -qsF "$PWD/.venv" .venv/pyvenv.cfg || ! .venv/bin/python -c '' 2>/dev/null; then
    $PYTHON -m venv --clear --system-site-packages .venv
fi
# Beside apt, which takes minutes: a complete list without dependencies needs nothing of Debian's.
pip --no-deps --requirement requirements.txt &
python_packages=$!
if [[ -n $missing ]]; then
    apt install $missing || fail "apt-get could not install: $(echo $missing)"
fi
wait $python_packages || fail "pip could not install the Python packages."
pip --no-build-isolation --constraint constraints.txt --editable '.[dev]' ||
    fail "pip could not install fiberbend."
.venv/bin/python - <<'CHECK' || fail "pip brought its own numpy or scipy; dolfinx needs Debian's."
import numpy, scipy, sys
sys.exit(any(".venv" in module.__file__ for module in (numpy, scipy)))
CHECK
# Bytes of what every run imports; all of the packages would take longer than they ever save.
env -u PYTHONDONTWRITEBYTECODE .venv/bin/python -c \
    'import fiberbend.cli, fiberbend.reader.reader, matplotlib.pyplot, pyvista, rich.progress' ||
    fail "the installed packages do not import."
printf '%s\n' "$key" > "$STAMP"
echo "setup: done"
