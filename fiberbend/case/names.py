"""The models that a case may ask for.

A new model is a file `fiberbend/models/<name>.py`, with `_` for each `-` of the name, and a word
here: everything else finds it by this table.
"""

from __future__ import annotations

MODELS = (
    "analytic",
    "section",
    "cell",
    "rod",
    "body",
)
"""From the cheapest to the dearest: `auto` takes the first that supports everything."""
