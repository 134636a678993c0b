"""The rod by itself, and `model: rod` beside the whole body: `python -m bench.rod --help`."""
