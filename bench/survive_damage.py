"""Damage to case files: values, units, types, keys, structure and text, each by a seed."""

from __future__ import annotations

import copy
import math
import random
from collections.abc import Callable, Iterator
from typing import Any

import yaml

from bench.survive import ROOT

CASES = sorted([*(ROOT / "cases").glob("*.yaml"), *(ROOT / "cases" / "fig11").glob("*.yaml")])
UNITS = (
    *("mm", "m", "um", "nm", "km", "inch", "kPa", "Pa", "MPa", "GPa", "bar", "psi", "deg", "rad"),
    *("mL", "L", "g/cm^3", "kg/m^3", "N", "mN", "m/s^2", "1/m", "%", "K", "", "mm^2", "furlong"),
)
NUMBERS = ("0", "-1", "nan", "inf", "-inf", "1e-30", "1e30", "1e400", "1e-400", "0x10", "1_000")
VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, 1, -1, 3.5, 1e300, -1e-300, math.nan, math.inf, 10**30, "", " ", "x"),
    *("8", "8 mm", "-8 mm", "200 kPa", "90 deg", "auto", "~", "\0", "\U0001f40d", "x" * 3000),
    *([], {}, [[]], [None], {"": 1}, {"to": {"to": {"to": 1}}}, ["8 mm"] * 40, {"name": "kevlar"}),
)
"""What stands where something else is expected."""


Place = tuple[Any, Any]
"""A mapping or list, and a key of it."""


def places(value: Any) -> Iterator[Place]:
    """Every place within nested mappings and lists."""
    keys = list(value) if isinstance(value, dict) else range(len(value))
    for key in keys:
        yield value, key
        if isinstance(value[key], (dict, list)):
            yield from places(value[key])


def quantities(data: Any) -> list[Place]:
    """The places of texts that begin with a number."""
    found = []
    for holder, key in places(data):
        value = holder[key]
        if isinstance(value, str) and value[:1] in "0123456789-+.":
            found.append((holder, key))
    return found


def scaled(rng: random.Random, data: Any) -> None:
    """A quantity times a power of ten, or with another sign."""
    holder, key = rng.choice(quantities(data))
    number, _, unit = holder[key].partition(" ")
    factor = rng.choice([-1.0, 0.0, *(10.0 ** rng.uniform(-9, 9) for _ in range(6))])
    holder[key] = f"{float(number) * factor:.6g} {unit}"


def nudged(rng: random.Random, data: Any) -> None:
    """Some quantities changed by up to a half, as one does: most of these can be solved."""
    for holder, key in rng.sample(quantities(data), 3):
        number, _, unit = holder[key].partition(" ")
        holder[key] = f"{float(number) * rng.uniform(0.6, 1.5):.4g} {unit}"


def renumbered(rng: random.Random, data: Any) -> None:
    """A number that is none, or far off."""
    holder, key = rng.choice(quantities(data))
    holder[key] = f"{rng.choice(NUMBERS)} {holder[key].partition(' ')[2]}"


def other_unit(rng: random.Random, data: Any) -> None:
    """Another unit."""
    holder, key = rng.choice(quantities(data))
    holder[key] = f"{holder[key].partition(' ')[0]} {rng.choice(UNITS)}"


def other_value(rng: random.Random, data: Any) -> None:
    """A value of another type."""
    holder, key = rng.choice(list(places(data)))
    holder[key] = copy.deepcopy(rng.choice(VALUES))


def lost(rng: random.Random, data: Any) -> None:
    """A key or an entry less."""
    holder, key = rng.choice(list(places(data)))
    del holder[key]


def misspelt(rng: random.Random, data: Any) -> None:
    """A key that is spelt otherwise."""
    holder, key = rng.choice([place for place in places(data) if isinstance(place[0], dict)])
    at = rng.randrange(len(key))
    new = rng.choice([key[:at] + key[at + 1 :], f"{key}s", key.upper(), key.replace("-", "_"), ""])
    holder[new] = holder.pop(key)


def swapped(rng: random.Random, data: Any) -> None:
    """Two values in each other's place."""
    (one, a), (other, b) = rng.sample(list(places(data)), 2)
    # not a value with its own part: YAML has no such thing
    if isinstance(one[a], (dict, list)) or isinstance(other[b], (dict, list)):
        return swapped(rng, data)
    one[a], other[b] = other[b], one[a]
    return None


def moved(rng: random.Random, data: Any) -> None:
    """A part where another one belongs."""
    holder, key = rng.choice(list(places(data)))
    part = copy.deepcopy(holder[key])
    other, at = rng.choice(list(places(data)))
    other[at] = part


def crossed(rng: random.Random, data: Any) -> None:
    """A part, or an effect, of another case."""
    other = yaml.safe_load(rng.choice(CASES).read_text(encoding="utf-8"))
    name = rng.choice([*other, "effects", "effects"])
    if name == "effects":
        data[name].insert(rng.randrange(len(data[name]) + 1), rng.choice(other[name]))
    else:
        data[name] = other[name]


def other_model(rng: random.Random, data: Any) -> None:
    """Another model."""
    data["model"] = rng.choice(["analytic", "section", "cell", "body", "auto"])


def line_damage(rng: random.Random, text: str) -> str:
    """A line lost, doubled, moved or indented."""
    lines = text.splitlines()
    at = rng.randrange(len(lines))
    act = rng.randrange(4)
    if act == 0:
        del lines[at]
    elif act == 1:
        lines.insert(at, lines[at])
    elif act == 2:
        lines.insert(rng.randrange(len(lines)), lines.pop(at))
    else:
        lines[at] = rng.choice([" ", "  ", "\t", "- ", "#"]) + lines[at]
    return "\n".join(lines)


def character_damage(rng: random.Random, text: str) -> str:
    """Characters changed, or the end lost."""
    if rng.random() < 0.2:
        return text[: rng.randrange(len(text))]
    for _ in range(rng.randrange(1, 4)):
        at = rng.randrange(len(text))
        sign = rng.choice([*"{}[]:,&*!|>'\"%@`#-?~\t\0 \n0e.", "é", "\ufeff", "\U0001f40d"])
        text = text[:at] + sign + text[at + rng.randrange(2) :]
    return text


DAMAGE: dict[str, tuple[Callable[[random.Random, Any], Any], ...]] = {
    "values": (scaled, renumbered, nudged),
    "units": (other_unit,),
    "types": (other_value,),
    "keys": (lost, misspelt),
    "structure": (swapped, moved, crossed, other_model),
    "text": (line_damage, character_damage),
}
KINDS = tuple(DAMAGE)


def mutant(seed: int) -> tuple[str, str]:
    """The kind of damage and the text of a damaged case."""
    rng = random.Random(seed)
    kind = KINDS[seed % len(KINDS)]
    text = rng.choice(CASES).read_text(encoding="utf-8")
    acts = DAMAGE[kind]
    if kind == "text":
        return kind, rng.choice(acts)(rng, text)
    data = yaml.safe_load(text)
    for _ in range(rng.choice([1, 1, 2, 3])):
        # what the damage before has left may have no such place
        try:
            rng.choice(acts)(rng, data)
        except (IndexError, ValueError, KeyError, AttributeError, TypeError):
            continue
    return kind, yaml.safe_dump(data, sort_keys=False, allow_unicode=True)
