#!/usr/bin/env bash
# Installs FEniCSx and the Python environment .venv; does nothing when both are in place.
# `./setup.sh tools` adds what the documentation, the notebook and the test in a browser need;
# `./setup.sh ask` only says what would be taken, or in one line what is missing.
#
# On Debian 12 or 13 with root or sudo FEniCSx is Debian's. Elsewhere it comes as wheels from PyPI:
# any x86-64 Linux with Python from 3.12 to 3.14, no root. FIBERBEND_STACK=debian or wheel chooses,
# PYTHON names the Python that takes the wheels.
set -euo pipefail
cd "$(dirname "$0")"

STAMP=.venv/setup.stamp
mapfile -t packages < apt-packages.txt
inputs=(pyproject.toml requirements.txt requirements-wheel.txt constraints-debian1[23].txt apt-packages.txt
    setup.sh)

TOOLS_STAMP=.venv/tools.stamp
mapfile -t tool_packages < apt-packages-docs.txt

# Which of its arguments are not installed.
missing_packages() {
    comm -23 <(printf '%s\n' "$@" | sort) \
        <(dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' 2>/dev/null | sed -n 's/^ii //p' | sort -u)
}

fail() {
    printf 'setup: %s\n' "$*" >&2
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

# Sets python to one that can take the wheels; fails where there is none.
find_python() {
    local name
    for name in ${PYTHON:-$(kept 2) python3.13 python3.12 python3.14 python3 \
        "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.1[234].*/bin/python3}; do
        python=$(command -v "$name") && "$python" - 2>/dev/null <<'ASK' && return
import ensurepip, sys, venv
sys.exit(not (3, 12) <= sys.version_info[:2] <= (3, 14))
ASK
    done
    return 1
}

# Says why wheels cannot be installed here; nothing where they can.
wheel_refusal() {
    local libc
    libc=$(getconf GNU_LIBC_VERSION 2>/dev/null) || libc="another C library"
    if [[ $(uname -sm) != "Linux x86_64" ]]; then
        echo "the wheels are for x86-64 Linux, and this is $(uname -sm)"
    elif ! printf 'glibc 2.34\n%s\n' "$libc" | sort -CV || [[ $libc != glibc* ]]; then
        echo "the wheels need glibc 2.34, and this has $libc"
    elif ! find_python; then
        echo "the wheels need Python from 3.12 to 3.14 with its venv, which is not found${PYTHON:+: $PYTHON}"
    fi
}

# Sets release to 12 or 13 on such a Debian; fails elsewhere.
on_debian() {
    release=$(. /etc/os-release 2>/dev/null && echo "${ID:-} ${VERSION_ID:-}") || return 1
    [[ $release =~ ^debian\ (12|13)$ ]] || return 1
    release=${release#debian }
    command -v dpkg-query >/dev/null
}

# Stack (1) or Python (2) of a complete .venv: what was chosen once stays.
kept() {
    [[ -f $STAMP && -f .venv/stack && -x .venv/bin/python ]] && cut -d' ' -f"$1" .venv/stack || true
}

# Sets stack, python, and what of Debian's packages is missing.
choose_stack() {
    local why
    missing=
    stack=${FIBERBEND_STACK:-$(kept 1)}
    [[ $stack =~ ^(|debian|wheel)$ ]] || fail "FIBERBEND_STACK=$stack, expected debian or wheel"
    if [[ $stack != wheel ]] && on_debian; then
        missing=$(missing_packages "${packages[@]}")
        if [[ $stack == debian || -z $missing ]] || become_root; then
            stack=debian python=/usr/bin/python3
            return
        fi
    fi
    [[ $stack != debian ]] || fail "FIBERBEND_STACK=debian, but this is not Debian 12 or 13."
    why=$(wheel_refusal)
    if [[ -n $missing && -n $why ]]; then
        fail "without root or sudo, $why; an administrator can run:" \
            "apt-get install --no-install-recommends" $missing
    fi
    [[ -z $why || $stack != wheel ]] || fail "FIBERBEND_STACK=wheel, but $why"
    [[ -z $why ]] ||
        fail "FEniCSx comes from Debian 12 or 13, which this is not, or as wheels; $why"
    stack=wheel missing=
    find_python
    check_compiler
}

# Kernels are compiled when a case is run: said before minutes of installing.
check_compiler() {
    local compiler
    compiler=$("$python" -c 'import os, sysconfig
print((os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc").split()[0])')
    command -v "$compiler" >/dev/null ||
        fail "no C compiler: $compiler is not found; install gcc, or set CC."
    "$python" -c 'import os, sys, sysconfig
sys.exit(not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")))' ||
        fail "no Python.h of $python: install its headers (python3-dev), or set PYTHON to another."
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
    if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
        echo "setup: the test in a browser will be skipped: it needs Debian's chromium" >&2
        return 0
    fi
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
[[ $# -le 1 && $mode =~ ^(base|tools|ask)$ ]] || fail "usage: ./setup.sh [tools|ask]"
log=$(mktemp)
trap 'rm -f "$log"; kill $(jobs -p) 2>/dev/null || true' EXIT
choose_stack
if [[ $mode == ask ]]; then
    echo "$stack $python"
    exit 0
fi
# The folder is part of the key: a moved .venv has dead paths inside.
key=$({ pwd; echo "$stack $python"; cat "${inputs[@]}"; } | sha256sum)
if [[ -z $missing && -x .venv/bin/fiberbend && -f $STAMP && $(<"$STAMP") == "$key" ]]; then
    finish
fi
echo "setup: FEniCSx $([[ $stack == debian ]] && echo "of Debian $release" || echo "as wheels, by $python")"

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
options=() lists=(--requirement requirements.txt) constraints=requirements-wheel.txt
if [[ $stack == debian ]]; then
    options=(--system-site-packages) constraints=constraints-debian$release.txt
else
    lists+=(--requirement requirements-wheel.txt)
fi
if ! grep -qsF "$PWD/.venv" .venv/pyvenv.cfg || ! .venv/bin/python -c '' 2>/dev/null ||
    [[ $(cat .venv/stack 2>/dev/null) != "$stack $python" ]]; then
    "$python" -m venv --clear "${options[@]}" .venv
    echo "$stack $python" > .venv/stack
fi
rm -f "$STAMP" "$TOOLS_STAMP"
# Beside apt, which takes minutes: a complete list without dependencies needs nothing of Debian's.
pip --no-deps "${lists[@]}" &
python_packages=$!
if [[ -n $missing ]]; then
    apt install $missing || fail "apt-get could not install: $(echo $missing)"
fi
wait $python_packages || fail "pip could not install the Python packages; is the network up?"
pip --no-build-isolation --constraint "$constraints" --editable '.[dev]' ||
    fail "pip could not install fiberbend."
if [[ $stack == debian ]]; then
    .venv/bin/python - <<'CHECK' || fail "pip brought its own numpy or scipy; dolfinx needs Debian's."
import numpy, scipy, sys
sys.exit(any(".venv" in module.__file__ for module in (numpy, scipy)))
CHECK
elif ! why=$(.venv/bin/python -c 'import gmsh' 2>&1); then
    echo "setup: bodies cannot be meshed, sections and cells can: gmsh needs libraries of the system" \
        "(${why##*Error: }); Debian's are libglu1-mesa libxcursor1 libxft2 libxinerama1" >&2
fi
# Bytes of what every run imports; all of the packages would take longer than they ever save.
env -u PYTHONDONTWRITEBYTECODE .venv/bin/python -c \
    'import fiberbend.cli, fiberbend.reader.reader, matplotlib.pyplot, pyvista, rich.progress' ||
    fail "the installed packages do not import."
printf '%s\n' "$key" > "$STAMP"
echo "setup: done in $SECONDS s"
# of the first time, when nothing was there
[[ -f .venv/setup.seconds ]] || echo "$SECONDS" > .venv/setup.seconds
finish
