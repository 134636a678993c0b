#!/usr/bin/env bash
# CalculiX from Debian, and felupe in an environment of its own; does nothing when both are there.
set -euo pipefail
cd "$(dirname "$0")/../.."

HOME_OF=build/peers/felupe
WANTED=bench/peers/requirements.txt

if ! command -v ccx > /dev/null; then
    install=(apt-get install -q -y --no-install-recommends calculix-ccx)
    if [[ $(id -u) -eq 0 ]]; then
        apt-get update -q && DEBIAN_FRONTEND=noninteractive "${install[@]}"
    else
        printf 'peers: CalculiX is missing; run:  sudo %s\n' "${install[*]}" >&2
        exit 1
    fi
fi
if ! cmp -s "$WANTED" "$HOME_OF/wanted.txt"; then
    echo "peers: installing felupe into $HOME_OF"
    /usr/bin/python3 -m venv --clear "$HOME_OF"
    "$HOME_OF/bin/python" -m pip install -qq --disable-pip-version-check --no-deps -r "$WANTED"
    "$HOME_OF/bin/python" -c 'import felupe, pypardiso'
    cp "$WANTED" "$HOME_OF/wanted.txt"
fi
