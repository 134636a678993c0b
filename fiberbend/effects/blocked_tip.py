"""Roof along the top and post under the tip: the paper's test of the tip force."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fiberbend import columns as col
from fiberbend.effects.effect import ENDS, STRIPS, Built, Effect, Requests, Site
from fiberbend.effects.obstacles import over_crown, post_shape, roof_shape, under_cap
from fiberbend.effects.records import OnRod, RodSite
from fiberbend.schema.quantities import Length

if TYPE_CHECKING:
    from fiberbend.states.obstacles import Shape
    from geometry.actuator import Actuator
    from geometry.mesh.data import MeshData
    from geometry.sections.size import Strips

_STIFFNESS = 100.0
"""Strips on a rod are so many times as stiff as the wall."""
OF_STRIPS = "and no section shears: tip force up to 11 % too great, the roof's up to 30 %"
"""Of a rod between roof and post (docs/contact.md)."""


class BlockedTipEffect(Effect):
    """Roof along the top and post under the tip, v = 0: the paper's test of the tip force."""

    name = "blocked-tip"

    roof_width: Length = 4.0
    """Width of the strip along the crown on which the roof fixes the body."""
    post_length: Length = 2.0
    """Length of the strip at the end of the tip cap's underside that rests on the post."""

    def needs(self) -> dict[str, str]:
        """Ends."""
        text = "roof and post need the ends of a body (effect straight: the blocked uniform bend)"
        return {ENDS: text}

    def on_rod(self, site: RodSite) -> OnRod:
        """Both strips keep their height, as far as the sheath under them lets them."""
        from fiberbend.outline.sheath import under_strip
        from fiberbend.outline.skins import skin
        from rod.contact.touch import Touch

        assert site.body is not None, "strips are as stiff as what is under them"
        places = {
            "roof": ("crown", over_crown(site.actuator), (self.roof_width, 2)),
            "post": ("sole", under_cap(site.actuator), (self.post_length, 1)),
        }
        held = []
        for name, (surface, plane, strip) in places.items():
            stiffness, part = under_strip(site.body, *strip, self._rigid(site.body))
            points = skin(site, (surface,), self.strips())
            held.append((name, Touch(points, plane, stiffness, keeps=True, part=part)))
        return OnRod(tuple(("", touch) for _, touch in held), obstacles=tuple(held))

    @staticmethod
    def _rigid(site: Site) -> float:
        """Stiffness of strips, MPa/mm: that of obstacles that keep a body straight."""
        return _STIFFNESS * 3 * site.materials["wall"].initial_shear_modulus / site.actuator.wall

    def wants(self) -> dict[str, str]:
        """Roof and post as surfaces."""
        return {
            STRIPS: "roof and post are no surfaces of it: closed forms fix the tip rigidly, of a "
            f"rod the sheath alone yields, {OF_STRIPS} (docs/contact.md)",
        }

    def mirror_breaker(self) -> str:
        """None: both strips are symmetric."""
        return ""

    def keeps_straight(self) -> bool:
        """Between roof and post."""
        return True

    def strips(self) -> Strips:
        """Both."""
        from geometry.sections.size import Strips

        return Strips(roof_half_width=self.roof_width / 2, post_length=self.post_length)

    def obstacle_shapes(self, actuator: Actuator) -> dict[str, Shape]:
        """A bar along the crown, and a block under the tip."""
        return {
            "roof": roof_shape(actuator, self.roof_width),
            "post": post_shape(actuator, self.post_length),
        }

    def obstacle_forces(self, row: Mapping[str, Any]) -> dict[str, tuple[float, float, float]]:
        """The roof's presses down, the post's up."""
        known = (("roof", col.ROOF_FORCE, -1.0), ("post", col.TIP_FORCE, 1.0))
        return {
            name: (0.0, sign * float(row[column]), 0.0)
            for name, column, sign in known
            if row.get(column) is not None
        }

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """The strips' widths."""
        yield "strips: other roofs and posts move it by up to 12 % (docs/evidence/blocked.md)"

    def alone(self) -> str:
        """The section beside it is kept straight."""
        return ""

    def steps(self) -> int:
        """It is no load."""
        return 0

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """No displacement along y on both strips."""
        from fem.effects.supports import BlockedTip

        return Built((BlockedTip(),))

    def summary(self, site: Site, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
        """The force beside the paper's."""
        return tip_force_summary(site, self.strips(), rows[-1])


def tip_force_summary(site: Site, strips: Strips, row: Mapping[str, Any]) -> dict[str, Any]:
    """F L_f beside κ P of Polygerinos et al. 2015, eqs. (20) and (21).

    Args:
        site: κ is its chamber's first moment about y = 0.
        strips: L_f reaches from z = L to the middle of the post.
        row: the last row of the history; without a load the summary is empty.
    """
    if col.TIP_FORCE not in row:
        return {}
    lever = site.actuator.cap - strips.post_length / 2
    return {
        "blocked_tip": {
            "L_f_mm": lever,
            col.TIP_FORCE: row[col.TIP_FORCE],
            col.ROOF_FORCE: row[col.ROOF_FORCE],
            "F_L_f_Nmm": row[col.TIP_FORCE] * lever,
            "kappa_P_Nmm": site.actuator.chamber_moment * row[col.PRESSURE] * 1e-3,
            "tip_section_rotation_deg": row[col.ANGLE],
            **{name: row[name] for name in (col.BALANCE_FORCE, col.BALANCE_MOMENT) if name in row},
        }
    }
