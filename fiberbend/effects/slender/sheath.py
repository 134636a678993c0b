"""How the sheath of an actuator yields under a strip that presses on it.

A bonded layer of rubber of thickness h and Young's modulus E under a long strip takes
E (4/3)(1 + S²) over its thickness, with the shape factor S = loaded over free area (Gent and
Lindley 1959, The compression of bonded rubber blocks, doi 10.1243/PIME_PROC_1959_173_022_02).
A strip of width w from whose both sides the rubber escapes has S = w/2h; from one side, w/h.
"""

from __future__ import annotations

from fiberbend.effects.records import Site


def under_strip(site: Site, width: float, sides: int, obstacle: float) -> tuple[float, float]:
    """Stiffness of obstacle and sheath one behind the other.

    Args:
        site: the actuator with its materials.
        width: of the strip, mm.
        sides: to which the rubber under it escapes, 1 or 2.
        obstacle: stiffness of the obstacle, MPa/mm.

    Returns:
        Pressure per depth, MPa/mm, and the part of a depth that is in the obstacle.
    """
    thickness = site.actuator.sheath
    if thickness is None:
        return obstacle, 1.0
    rubber = site.materials.get("sheath", site.materials["wall"])
    factor = width / (sides * thickness)
    sheath = 4 * rubber.initial_shear_modulus * (1 + factor**2) / thickness
    both = 1 / (1 / obstacle + 1 / sheath)
    return both, both / obstacle
