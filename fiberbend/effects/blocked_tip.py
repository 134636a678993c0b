"""Roof along the top and post under the tip: the paper's test of the tip force."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fiberbend.effects.effect import ENDS, STRIPS, Built, Effect, Requests, Site
from fiberbend.schema.quantities import Length

if TYPE_CHECKING:
    from geometry.mesh.data import MeshData
    from geometry.sections.size import Strips


class BlockedTipEffect(Effect):
    """Roof along the top and post under the tip, held in y: the paper's test of the tip force."""

    name = "blocked-tip"

    roof_width: Length = 4.0
    """Width of the strip along the crown on which the roof holds the body."""
    post_length: Length = 2.0
    """Length of the strip at the end of the tip cap's underside that rests on the post."""

    def needs(self) -> dict[str, str]:
        """Ends."""
        text = "roof and post need the ends of a body (effect straight: the blocked uniform bend)"
        return {ENDS: text}

    def wants(self) -> dict[str, str]:
        """Roof and post as surfaces."""
        return {
            STRIPS: "in closed forms the tip is held rigidly, without roof, post and sheath",
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

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """The strips' widths."""
        yield "strips: other roofs and posts move it by up to 12 % (docs/accuracy_blocked.md)"

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
        row: the last row of the history; nothing is said of one without a load.
    """
    if "tip_force_N" not in row:
        return {}
    lever = site.actuator.cap - strips.post_length / 2
    return {
        "blocked_tip": {
            "L_f_mm": lever,
            "tip_force_N": row["tip_force_N"],
            "roof_force_N": row["roof_force_N"],
            "F_L_f_Nmm": row["tip_force_N"] * lever,
            "kappa_P_Nmm": site.actuator.chamber_moment * row["pressure_kPa"] * 1e-3,
            "tip_section_rotation_deg": row["angle_deg"],
            "balance_force": row["balance_force"],
            "balance_moment": row["balance_moment"],
        }
    }
