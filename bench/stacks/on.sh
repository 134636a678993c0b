#!/usr/bin/env bash
# Runs targets of make in a copy of this source on another stack, kept in build/:
#
#     bench/stacks/on.sh wheel test-fast        # wheels from PyPI, beside what this machine has
#     bench/stacks/on.sh debian13 test-fast     # a Debian of its own under build/debian13; needs root
#     bench/stacks/on.sh image                  # the same, bare, for the steps of Dockerfile
#
# Where that stack cannot be had here, one line says why, and the exit code is 0.
set -euo pipefail
cd "$(dirname "$0")/../.."

stack=${1:?which stack: wheel, debian12, debian13 or image}
targets=("${@:2}")
root=$PWD/build/$stack

skip() {
    printf 'on %s: SKIPPED, nothing was run: %s\n' "$stack" "$*"
    exit 0
}

# The source without what was made from it; of the copy, only its environment stays.
copy_source() {
    mkdir -p "$1"
    find "$1" -mindepth 1 -maxdepth 1 ! -name .venv -exec rm -rf {} +
    tar -c --exclude=./.git --exclude=./.venv --exclude=./build --exclude=./runs --exclude=./docs/_build \
        --exclude=__pycache__ --exclude='./.*_cache' --exclude='*.egg-info' . | tar -x -C "$1"
}

# What the copy has measured of its stack.
bring_records() {
    cp -u "$1"/bench/stacks/*.json bench/stacks/ 2>/dev/null || true
}

# Whether a mirror of Debian ($1) has the release $2 for us now.
reached() {
    python3 -c 'import sys, urllib.request; urllib.request.urlopen(sys.argv[1], timeout=30).read()' \
        "$1/dists/$2/InRelease" 2>/dev/null
}

# Runs a command in the source of the Debian in $root. Mounts of this process alone: they end with
# it, and `rm -r build` meets none of them.
inside() {
    unshare --mount --propagation private bash -euc '
        mount -t proc proc "$0/proc"; mount --rbind /dev "$0/dev"; mount --rbind /sys "$0/sys"
        exec chroot "$0" env -C /fiberbend -u PIP_FIND_LINKS -u PYTHONPATH -u PYTHON -u CC HOME=/root \
            LC_ALL=C.UTF-8 PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
            FIBERBEND_STACK=debian "$@"' "$root" "$@"
}

on_wheel() {
    local why python
    copy_source "$root"
    cd "$root"
    export FIBERBEND_STACK=wheel
    why=$(./setup.sh ask 2>&1) || skip "${why#setup: }"
    python=${why##* }
    if ! ./setup.sh; then
        "$python" -m pip download -qq --no-cache-dir --no-deps --dest "$PWD/build" \
            "$(grep fenics-ufl requirements-wheel.txt)" 2>/dev/null || skip "pip reaches no registry."
        exit 1
    fi
    .venv/bin/python -c 'import gmsh' 2>/dev/null ||
        skip "the gmsh of PyPI needs libglu1-mesa libxcursor1 libxft2 libxinerama1."
    make "${targets[@]}"
    cd "$OLDPWD"
    bring_records "$root"
}

# Makes a bare Debian of a name in $root, with packages beside, unless it is there; sets mirror.
make_debian() {
    local name=$1 beside=$2
    [[ $(id -u) -eq 0 ]] || skip "a Debian of its own needs root: chroot, debootstrap."
    unshare --mount true 2>/dev/null || skip "this root may not mount."
    mirror=${MIRROR:-$(sed -n 's/^URIs: *\(http[^ ]*debian\/\?\)$/\1/p' /etc/apt/sources.list.d/*.sources \
        2>/dev/null | head -n 1)}
    mirror=${mirror:-http://deb.debian.org/debian}
    [[ ! -f $root.made ]] || return 0
    reached "$mirror" "$name" || skip "$mirror is not reached."
    command -v debootstrap >/dev/null ||
        { apt-get update -qq && apt-get install -qq -y --no-install-recommends debootstrap; } \
            >/dev/null 2>&1 || skip "debootstrap is missing, and apt-get cannot install it."
    rm -rf "$root"
    mkdir -p "$root"
    echo "on $stack: making it in build/$stack, a minute"
    debootstrap --variant=minbase ${beside:+--include="$beside"} "$name" "$root" "$mirror" \
        > "$root.log" 2>&1 || { tail -n 5 "$root.log" >&2; exit 1; }
    # How this machine reaches the network.
    cp -r /etc/apt/apt.conf.d/. "$root/etc/apt/apt.conf.d/"
    mkdir -p "$root/etc/ssl/certs"
    cp -L --remove-destination /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
    cp -L --remove-destination /etc/resolv.conf /etc/hosts "$root/etc/"
    touch "$root.made"
}

on_debian() {
    make_debian "$1" ca-certificates,git,make
    copy_source "$root/fiberbend"
    if ! inside ./setup.sh; then
        reached "$mirror" "$1" || skip "$mirror is not reached."
        [[ ! -x $root/fiberbend/.venv/bin/python ]] ||
            inside .venv/bin/python -m pip download -qq --no-cache-dir --no-deps --dest build \
                "$(grep -m 1 == requirements.txt)" 2>/dev/null || skip "pip reaches no registry."
        exit 1
    fi
    inside make "${targets[@]}"
    bring_records "$root/fiberbend"
}

# Always from nothing: an image is what its steps make, and not what is left of the last time.
on_image() {
    rm -f "$root.made"
    make_debian trixie ""
    python3 bench/stacks/image.py "$root"
}

case $stack in
    wheel) on_wheel ;;
    debian12) on_debian bookworm ;;
    debian13) on_debian trixie ;;
    image) on_image ;;
    *) echo "on.sh: $stack, expected wheel, debian12, debian13 or image" >&2; exit 2 ;;
esac
