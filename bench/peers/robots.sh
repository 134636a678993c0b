#!/usr/bin/env bash
# PyElastica and MuJoCo in an environment of their own; does nothing when they are there.
set -euo pipefail
cd "$(dirname "$0")/../.."

HOME_OF=build/peers/robots
WANTED=bench/peers/robots.txt

if ! cmp -s "$WANTED" "$HOME_OF/wanted.txt"; then
    echo "robots: installing PyElastica and MuJoCo into $HOME_OF"
    "${PYTHON:-/usr/bin/python3}" -m venv --clear "$HOME_OF"
    "$HOME_OF/bin/python" -m pip install -qq --disable-pip-version-check --no-deps -r "$WANTED"
    "$HOME_OF/bin/python" -c 'import elastica, mujoco'
    cp "$WANTED" "$HOME_OF/wanted.txt"
fi
