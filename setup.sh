#!/usr/bin/env bash
# Installs Debian's FEniCSx and the Python environment .venv; does nothing when both are in place.
# `./setup.sh tools` adds what the documentation, the notebook and the test in a browser need.
set -euo pipefail
cd "$(dirname "$0")"

PYTHON=/usr/bin/python3
STAMP=.venv/setup.stamp
mapfile -t packages < apt-packages.txt
# The folder is part of the key: a moved .venv has dead paths inside.
inputs=(pyproject.toml requirements.txt constraints.txt apt-packages.txt setup.sh)
key=$({ pwd; cat "${inputs[@]}"; } | sha256sum)

TOOLS_STAMP=.venv/tools.stamp
mapfile -t tool_packages < apt-packages-docs.txt

# Which of its arguments are not installed.
missing_packages() {
    comm -23 <(printf '%s\n' "$@" | sort) \
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

# Sets as_root to what makes a command root's; fails where nothing does.
become_root() {
    as_root=()
    [[ $(id -u) -eq 0 ]] && return
    command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [[ -t 0 ]]; } || return 1
    as_root=(sudo)
}

install_tools() {
    local tools_key missing
    tools_key=$({ pwd; cat setup.sh requirements.txt requirements-docs.txt; } | sha256sum)
    if ! [[ -f $TOOLS_STAMP && $(<"$TOOLS_STAMP") == "$tools_key" ]]; then
        echo "setup: installing what documentation and notebook need into .venv"
        pip --no-deps --requirement requirements-docs.txt ||
            fail "pip could not install the packages of requirements-docs.txt."
        printf '%s\n' "$tools_key" > "$TOOLS_STAMP"
    fi
    # Only the test in a browser needs these: without them it is skipped, all else works.
    missing=$(missing_packages "${tool_packages[@]}")
    [[ -n $missing ]] || return 0
    if ! become_root; then
        echo "setup: the test in a browser will be skipped: installing $(echo $missing) needs root" \
            "or sudo. An administrator can run:  apt-get install --no-install-recommends" \
            $missing >&2
        return 0
    fi
    echo "setup: installing Debian packages for the test in a browser:" $missing
    apt install $missing || { apt update && apt install $missing; } ||
        echo "setup: the test in a browser will be skipped: apt-get could not install" $missing >&2
}

finish() {
    [[ $mode == base ]] || install_tools
    exit 0
}

mode=${1:-base}
[[ $# -le 1 && $mode =~ ^(base|tools)$ ]] || fail "usage: ./setup.sh [tools]"
command -v dpkg-query >/dev/null || fail "this is not a Debian machine; Debian 12 is what is supported."
log=$(mktemp)
trap 'rm -f "$log"; kill $(jobs -p) 2>/dev/null || true' EXIT
missing=$(missing_packages "${packages[@]}")
if [[ -z $missing && -x .venv/bin/fiberbend && -f $STAMP && $(<"$STAMP") == "$key" ]]; then
    finish
fi

if [[ -n $missing ]]; then
    become_root ||
        fail "these Debian packages are missing, and installing them needs root or sudo. Let an
administrator run:  apt-get install --no-install-recommends $(echo $missing)"
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
rm -f "$STAMP" "$TOOLS_STAMP"
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
finish
