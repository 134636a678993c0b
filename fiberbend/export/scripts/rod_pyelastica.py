"""An actuator as a Cosserat rod of PyElastica, from the numbers in rod.json beside this file.

    python rod_pyelastica.py --pressure 100 --gravity 0 -9.81 0
    python rod_pyelastica.py --pressure 100 --tip-force 0 0.1 0 --seconds 2

It is clamped at the root, the pressure rises over the first second and stays, and what moves is
damped until it rests. In your own scene take `Rod`, `add_rod` and `Pressure`, with a pressure of
your own as a function of time.

The rod's line is `axis` of rod.json: it lies where the section's stretch and bending are not
coupled. Its rest strains and stiffness follow the pressure. Masses lie where the section's centre
is; that their centre is beside the line turns it by its weight, not by its inertia. rod.json has no
stiffness against shear: the one here makes the tip fall a thousandth further.

PyElastica's forces are S (σ − σ₀)/e and B (κ − κ₀)/e³ with the stretch e: S and B are those of
rod.json times e and e³ at rest.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path

import elastica as ea
import numpy as np

MM, KPA = 1e-3, 1e3
SPEED = 0.5
"""Time step in parts of that at which the stiffest motion is no longer stable."""


class Rod:
    """The numbers of rod.json in m, N and kg.

    Args:
        path: of rod.json.
        chamber: elements between the caps.
        cap: elements of each cap.
    """

    def __init__(self, path: Path, chamber: int = 40, cap: int = 3) -> None:
        self.data = json.loads(path.read_text(encoding="utf-8"))
        if (self.data["format"], self.data["version"]) != ("fiberbend-rod", 2):
            raise ValueError(f"{path}: version 2 of the format fiberbend-rod expected")
        if not self.data["mass"]["known"]:
            raise ValueError(
                f"{path}: without masses nothing moves: {self.data['mass']['missing']}"
            )
        geometry, axis = self.data["geometry"], self.data["axis"]
        ends, middle = geometry["cap_length_mm"] * MM, geometry["chamber_length_mm"] * MM
        own, beside = np.full(chamber, middle / chamber), np.full(cap, ends / cap)
        self.lengths = np.concatenate([beside, own, beside])
        self.in_chamber = np.repeat([False, True, False], [cap, chamber, cap])
        self.root = -ends
        self.place = np.array([axis["x_mm"], axis["y_mm"]]) * MM
        """Of the line, from the centroids."""
        self.pressures = np.array(self.data["section"]["pressure_kPa"])
        names = ("curvature", "side_curvature", "twist")
        self._curvatures = np.array([axis[f"rest_{name}_1_per_mm"] for name in names]).T / MM
        self._stretch = np.array(axis["rest_stretch"])
        self._axial = np.array(axis["axial_stiffness_N"])
        self._bending = np.array(axis["bending_stiffness_N_mm2"]) * MM**2
        self._shear = np.array(self.data["shear"]["section_N"])
        self._cap_shear = np.array(self.data["shear"]["cap_N"])
        self._cap_axial = self.data["cap"]["axial_stiffness_N"]
        self._cap_bending = np.array(self.data["cap"]["bending_stiffness_N_mm2"]) * MM**2
        self._added = self._ends(chamber, cap)
        """Lengths in m and turns of the elements by the ends of the chamber, by pressure."""
        self._stiffer = np.ones(len(self.lengths))
        self._stiffer[:cap] = self.data["ends"]["root_cap_over_cap_stiffness"]

    def _ends(self, chamber: int, cap: int) -> np.ndarray:
        ends, middle = self.data["ends"], self.data["geometry"]["chamber_length_mm"]
        near = max(1, min(round(ends["zone_mm"] / middle * chamber), chamber // 2))
        counts = np.cumsum([0, cap, near, chamber - 2 * near, near, cap])
        added = np.zeros((len(self.pressures), len(self.lengths), 4))
        x, y = self.place
        for number, name in ((0, "root_cap"), (1, "root_end"), (3, "tip_end"), (4, "tip_cap")):
            part, (first, last) = ends[name], counts[number : number + 2]
            turns = [np.array(part[key]) for key in ("turn_rad", "side_turn_rad", "twist_rad")]
            longer = np.array(part["lengthening_mm"]) * MM + y * turns[0] - x * turns[1]
            added[:, first:last] = (np.array([longer, *turns]).T / (last - first))[:, None]
        return added

    def at(self, kpa: float) -> tuple[float, np.ndarray, float, np.ndarray, np.ndarray, np.ndarray]:
        """Of the chamber's section, and of the elements at its ends.

        Args:
            kpa: pressure, within the range of rod.json.

        Returns:
            Stretch and curvatures at rest, axial, bending and shear stiffness; length in m and
            turns of each element by the ends.
        """
        low, high = self.pressures[[0, -1]]
        if not low <= kpa <= high:
            raise ValueError(f"{kpa:g} kPa: rod.json reaches from {low:g} to {high:g} kPa")
        place = min(
            int(np.searchsorted(self.pressures, kpa, side="right")), len(self.pressures) - 1
        )
        before = place - 1
        part = (kpa - self.pressures[before]) / (self.pressures[place] - self.pressures[before])
        tables = (self._stretch, self._curvatures, self._axial, self._bending, self._shear)
        stretch, curvatures, axial, bending, shear, added = (
            (1 - part) * table[before] + part * table[place] for table in (*tables, self._added)
        )
        return float(stretch), curvatures, float(axial), bending, shear, added

    def put(self, rod: ea.CosseratRod, kpa: float) -> None:
        """Write rest strains and stiffness at a pressure into a rod."""
        stretch, curvatures, axial, bending, shear, added = self.at(kpa)
        inside = self.in_chamber
        rest = np.where(inside, stretch, 1.0) + added[:, 0] / self.lengths
        rod.rest_sigma[2] = rest - 1.0
        along = rest * np.where(inside, axial, self._stiffer * self._cap_axial)
        for way, (own_shear, cap_shear) in enumerate(zip(shear, self._cap_shear, strict=True)):
            rod.shear_matrix[way, way] = rest * np.where(inside, own_shear, cap_shear)
        rod.shear_matrix[2, 2] = along
        # a node turns by what bends in the halves beside it; the ends have no node of their own
        halves = np.array([self.lengths[:-1], self.lengths[1:]]) / 2
        between = halves.sum(axis=0)
        halves[0, 0], halves[1, -1] = self.lengths[0], self.lengths[-1]
        own, caps = (
            np.sum(halves * np.array([part[:-1], part[1:]]), axis=0) / between
            for part in (inside, ~inside / self._stiffer)
        )
        turned = added[:, 1:].T / self.lengths
        ends = (halves[0] * turned[:, :-1] + halves[1] * turned[:, 1:]) / between
        rod.rest_kappa[:] = own * curvatures[:, None] + ends
        softness = own[:, None, None] * np.linalg.inv(bending)
        softness = softness + caps[:, None, None] * np.linalg.inv(self._cap_bending)
        lengths = rest * self.lengths
        cube = ((lengths[:-1] + lengths[1:]) / 2 / between) ** 3
        rod.bend_matrix[:] = np.moveaxis(cube[:, None, None] * np.linalg.inv(softness), 0, -1)

    def masses(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Mass of the elements, place of its centre from the line, and inertia about the line."""
        about = self.data["mass"]
        mass, arm, inertia = [], [], []
        for length, inside in zip(self.lengths, self.in_chamber, strict=True):
            part = about["section" if inside else "cap"]
            m = part["per_length_kg_per_mm"] / MM * length
            xx, yy, xy = np.array(part["second_xx_yy_xy_kg_mm"]) * MM * length
            centre = np.array([part["centre_x_mm"], part["centre_y_mm"]]) * MM - self.place
            a, b = centre
            xx, yy, xy = xx + m * a * a, yy + m * b * b, xy + m * a * b
            thick = m * length**2 / 12
            mass.append(m)
            arm.append([a, b, 0.0])
            inertia.append([[yy + thick, -xy, 0], [-xy, xx + thick, 0], [0, 0, xx + yy]])
        return np.array(mass), np.array(arm), np.array(inertia)

    def time_step(self) -> float:
        """A stable one, s."""
        mass, _, inertia = self.masses()
        inside, stiffer = self.in_chamber, self._stiffer
        axial = np.where(inside, self._axial.max(), stiffer * self._cap_axial)
        bending = np.where(inside, self._bending.max(), stiffer * self._cap_bending.max())
        sheared = np.where(inside, self._shear.max(), self._cap_shear.max())
        own, h = np.linalg.eigvalsh(inertia)[:, 0], self.lengths
        along = 4 * axial / (h * mass)
        turning = (sheared * h + 4 * bending / h) / own
        return SPEED * 2 / float(np.sqrt(max(along.max(), turning.max())))


class Pressure(ea.NoForces):
    """The pressure in the chamber as a function of time: it moves what the rod is without load.

    Args:
        numbers: of the rod.
        kpa: pressure in kPa by time in s.
    """

    def __init__(self, numbers: Rod, kpa: Callable[[float], float]) -> None:
        super().__init__()
        self._numbers, self._kpa, self._now = numbers, kpa, np.nan

    def apply_forces(self, system: ea.CosseratRod, time: float = 0.0) -> None:
        """Write the rest state of this moment."""
        kpa = float(self._kpa(float(time)))
        if kpa != self._now:
            self._numbers.put(system, kpa)
            self._now = kpa


class Weight(ea.NoForces):
    """Weight at the sections' own centres.

    Args:
        numbers: of the rod.
        gravity: acceleration in space, m/s².
    """

    def __init__(self, numbers: Rod, gravity: np.ndarray) -> None:
        super().__init__()
        mass, arm, _ = numbers.masses()
        self._gravity, self._moment = gravity, (mass[:, None] * arm[:, :2]).T

    def apply_forces(self, system: ea.CosseratRod, time: float = 0.0) -> None:
        """Forces on the nodes."""
        system.external_forces += self._gravity[:, None] * system.mass

    def apply_torques(self, system: ea.CosseratRod, time: float = 0.0) -> None:
        """Moments of the elements, in their own axes."""
        x, y, z = np.tensordot(self._gravity, system.director_collection, axes=(0, 1))
        a, b = self._moment
        system.external_torques[0] += b * z
        system.external_torques[1] -= a * z
        system.external_torques[2] += a * y - b * x


class TipForce(ea.NoForces):
    """A force at the centroid of the tip's outer face that keeps its direction.

    Args:
        numbers: of the rod.
        force: in space, N.
    """

    def __init__(self, numbers: Rod, force: np.ndarray) -> None:
        super().__init__()
        self._force, self._arm = force, np.array([*-numbers.place, 0.0])

    def apply_forces(self, system: ea.CosseratRod, time: float = 0.0) -> None:
        """On the last node."""
        system.external_forces[:, -1] += self._force

    def apply_torques(self, system: ea.CosseratRod, time: float = 0.0) -> None:
        """On the last element, in its own axes."""
        own = system.director_collection[..., -1] @ self._force
        system.external_torques[:, -1] += np.cross(self._arm, own)


class Scene(ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Damping, ea.CallBacks):
    """What PyElastica runs."""


def add_rod(scene: Scene, numbers: Rod) -> ea.CosseratRod:
    """Put the straight rod into a scene, clamped at its root, with its masses."""
    z = numbers.root + np.concatenate([[0.0], np.cumsum(numbers.lengths)])
    position = np.zeros((3, len(z)))
    position[:2], position[2] = numbers.place[:, None], z
    radius = numbers.data["geometry"]["radius_mm"] * MM
    rod = ea.CosseratRod.straight_rod(
        len(numbers.lengths),
        position[:, 0],
        np.array([0.0, 0.0, 1.0]),
        np.array([1.0, 0.0, 0.0]),
        float(numbers.lengths.sum()),
        radius,
        1000.0,  # replaced below, as are the moduli
        youngs_modulus=1e6,
        position=position,
    )
    mass, _, inertia = numbers.masses()
    rod.mass[:] = 0.0
    rod.mass[:-1] += mass / 2
    rod.mass[1:] += mass / 2
    rod.mass_second_moment_of_inertia[:] = np.moveaxis(inertia, 0, -1)
    rod.inv_mass_second_moment_of_inertia[:] = np.moveaxis(np.linalg.inv(inertia), 0, -1)
    rod.rest_sigma[:] = 0.0
    rod.shear_matrix[:] = 0.0
    numbers.put(rod, float(numbers.pressures[0]))
    scene.append(rod)
    scene.constrain(rod).using(
        ea.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,)
    )
    return rod


def tip(numbers: Rod, rod: ea.CosseratRod) -> tuple[np.ndarray, float]:
    """Place of the centroid of the tip's outer face in mm, and the angle of bending in degrees."""
    axes = rod.director_collection[..., -1]
    place = rod.position_collection[:, -1] - numbers.place @ axes[:2]
    lengths = (numbers.lengths[:-1] + numbers.lengths[1:]) / 2
    return place / MM, float(np.degrees(lengths @ rod.kappa[0]))


def main() -> None:
    """Bend, wait, print the tip."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--pressure", type=float, required=True, help="kPa")
    options.add_argument("--gravity", type=float, nargs=3, default=(0, 0, 0), help="m/s²")
    options.add_argument("--tip-force", type=float, nargs=3, default=(0, 0, 0), help="N")
    options.add_argument("--seconds", type=float, default=2.5)
    options.add_argument("--ramp", type=float, default=1.0, help="s")
    options.add_argument("--damping", type=float, default=15.0, help="1/s, of all velocities")
    options.add_argument("--elements", type=int, default=40, help="of the chamber")
    given = options.parse_args()
    numbers = Rod(Path(__file__).with_name("rod.json"), given.elements)
    least = float(numbers.pressures[0])
    numbers.at(given.pressure)
    scene = Scene()
    rod = add_rod(scene, numbers)
    step = numbers.time_step()
    scene.dampen(rod).using(
        ea.AnalyticalLinearDamper, uniform_damping_constant=given.damping, time_step=step
    )

    def pressure(time: float) -> float:
        return least + (given.pressure - least) * min(1.0, time / given.ramp)

    scene.add_forcing_to(rod).using(Pressure, numbers, pressure)
    for what, vector in ((Weight, given.gravity), (TipForce, given.tip_force)):
        if any(vector):
            scene.add_forcing_to(rod).using(what, numbers, np.array(vector, dtype=float))
    scene.finalize()
    stepper, time = ea.PositionVerlet(), 0.0
    for _ in range(round(given.seconds / step)):
        time = stepper.step(scene, time, step)
    place, angle = tip(numbers, rod)
    speed = float(np.abs(rod.velocity_collection).max())
    print(
        json.dumps(
            {
                "pressure_kPa": given.pressure,
                "tip_angle_deg": round(angle, 4),
                "tip_mm": [round(float(part), 4) for part in place],
                "speed_mm_per_s": round(speed / MM, 4),
            }
        )
    )


if __name__ == "__main__":
    main()
