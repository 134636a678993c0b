"""Settings of a winding whose change moves an answer little or not at all."""

from __future__ import annotations

from fiberbend.effects.wound.thread import FiberSpec

_STIFF = 1e3
"""Modulus in MPa from which a thread hardly stretches."""


def hardly_felt(made_of: FiberSpec | None, resolved: bool) -> dict[str, str]:
    """Of a stiff thread its modulus; spread over the surface, also what lies between turns.

    Args:
        made_of: the thread of a pattern; None of families.
        resolved: the model resolves the turns.

    Returns:
        Keys of the winding, each with the reason.
    """
    felt = {}
    spread = "its winding is spread over the surface, without a width"
    if made_of is None:
        # nobody has measured what else such a winding hardly feels
        return {} if resolved else dict.fromkeys(("width", "lines"), spread)
    stiff = made_of.thread().modulus >= _STIFF
    if not resolved:
        felt["pitch"] = (
            "its winding is spread over the surface, so that no rubber bulges between the "
            "turns: a pitch of 1.5 to 6 mm moves the pressure for 90° by 1 %, by 11 % where "
            "every turn lies by itself (docs/sweep.md)"
        )
        felt |= dict.fromkeys(("width", "lines"), spread)
        if stiff:
            felt["fiber"] = (
                "its winding is spread over the surface, and its thread hardly stretches: a "
                "diameter of 0.1 to 1 mm moves the pressure for 90° by +1 %, by −3 % where "
                "every turn lies by itself (docs/sweep.md)"
            )
    if stiff:
        felt["fiber.modulus"] = (
            "a thread of 1 GPa or more hardly stretches: 1 to 300 GPa move the pressure for "
            "90° by 1 % in every model (docs/sweep.md)"
        )
    return felt
