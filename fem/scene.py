"""A scene is a list of effects; compiled, it is a potential with two derivatives."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc

from fem import compat
from fem.assembly import Assembler
from fem.derivatives import derivatives
from fem.effects.effect import Discrete, Effect, fixed_dofs, opposite_free, structures
from fem.kinematics.body import Body
from fem.kinematics.domain import Domain
from fem.kinematics.kinematics import Kinematics
from fem.kinematics.place import Place, place
from fem.libraries import together
from fem.matrix import may_free
from fem.own_code import OwnCode
from fem.ranks import total
from fem.round_off import noise_along, probed, summed_noise
from geometry.mesh.data import MeshData

Floats = npt.NDArray[np.float64]

FLOOR = 1e-30
"""Scale of forces where there are none, N."""


class Scene(OwnCode):
    """A body under a sum of effects, Π(w, q) = Σ_e Π_e(w, q), ready to be solved.

    The effects are sorted, so that their order in the list never matters. What no effect asks
    for has no dof and no kernel.

    Args:
        domain: the mesh.
        effects: the summands; each key at most once.
        kinematics: makes the kinematics from the domain and the names of the fields.

    Attributes:
        body: kinematics with the unknowns.
        keys: names of the effects, sorted.
        effects: the effects by these names.
        natural: global scalars in which the potential is stationary at an equilibrium.
        force_scale: scale of the forces in the last residual, N.
        volume_scale: norm of ∫ φ dX over the pressure field's test functions, mm³.
        force_noise: norm of the forces that round-off in all potentials makes at rest, N.
        solid_noise: the part of it that is not of potentials with own code, N.
        noise_along: what round-off makes there of ∂Π/∂q of natural scalars, held or not, by name.
        volumetric: owned dofs of the pressure field, (owned,).
        free: local dofs (owned and ghosts) that no constraint fixes, (local,).
        free_opposite: the same for modes of the symmetry opposite to that of half a body; None of
            a whole one, and where they cannot be told.
        discrete: by key, the potentials with own code.

    Raises:
        ValueError: an effect given twice.
    """

    def __init__(
        self,
        domain: Domain,
        effects: Iterable[Effect],
        kinematics: Callable[[Domain, Iterable[str]], Kinematics] = Body,
    ) -> None:
        ordered = sorted(effects, key=lambda effect: effect.key)
        self.keys = [effect.key for effect in ordered]
        for key in self.keys:
            if self.keys.count(key) > 1:
                raise ValueError(f"the effect {key} is given twice")
        self.effects = {effect.key: effect for effect in ordered}
        self.domain = domain
        self.body = kinematics(domain, (name for effect in ordered for name in effect.fields))
        self.force_scale = 1.0
        self._force_floor = FLOOR
        self._second: dict[tuple[str, str], float] = {}
        self._loads: dict[str, Floats] = {}
        self._at: Floats | None = None
        self.discrete: dict[str, Discrete] = {}
        potentials: dict[str, Any] = {}
        for effect in ordered:
            form = effect.potential(self.body)
            if form is not None:
                potentials[effect.key] = form
            discrete = effect.discrete(self.body)
            if discrete is not None:
                self.discrete[effect.key] = discrete
        fixed = {k: v for effect in ordered for k, v in effect.fixed_scalars().items()}
        self.take_in()
        self._rest = {name: float(item.value) for name, item in self.body.scalars.items()}
        self.hold(fixed)
        self._compile(potentials)
        constraints = [item for effect in ordered for item in effect.constraints()]
        self.free, self._fixed, self._fixed_values = fixed_dofs(self.body, constraints)
        self.volumetric = self.body.volumetric()
        self._measure()
        self.free_opposite = opposite_free(ordered, self.body)

    def refit(self, effects: Iterable[Effect], data: MeshData) -> bool:
        """Take effects that differ by numbers alone, and a mesh by its nodes; at rest; one rank.

        No kernel is looked for, which takes most of the time of a small scene.

        Args:
            effects: those that the scene is to have.
            data: its mesh.

        Returns:
            Whether it could; where it could not, nothing has changed.
        """
        ordered = sorted(effects, key=lambda effect: effect.key)
        mine, theirs = (structures(given) for given in (self.effects.values(), ordered))
        if None in theirs.values() or mine != theirs or not self.domain.like(data):
            return False
        body = self.body
        self.effects |= {effect.key: effect for effect in ordered}
        self.domain.move(data)
        body.moved()
        body.numbers.again()
        for effect in ordered:
            effect.potential(body)
        for key, old in self.discrete.items():
            new = self.effects[key].discrete(body)
            assert new is not None, "of one structure"
            self.discrete[key] = new
            if not np.array_equal(new.block_dofs, old.block_dofs):
                self._couplings[key] = self._assembler.blocks(new.block_dofs)
        self.begin()
        self._measure()
        return True

    def begin(self) -> None:
        """Go back to rest, without a load and without what was met since."""
        for name, value in self._rest.items():
            self.set_scalar(name, value)
        self._forget()
        self._force_floor = FLOOR
        self.set(np.zeros(self.body.owned))
        self.predict(None)

    def _measure(self) -> None:
        """What volumes are measured by, and what round-off makes of forces, at rest."""
        self.volume_scale = 1.0
        if "volume" in self._forms:
            self.volume_scale = self.norm(self._sum(self._forms["volume"], ())[0])
        self.solid_noise = self._solid_noise()
        discretes = self.discrete.values()
        self.force_noise = float(np.hypot(summed_noise(self.body, discretes), self.solid_noise))
        every = (*self.body.natural, *self.added)
        self.noise_along = noise_along(self.body, discretes, every)

    def __del__(self) -> None:
        if hasattr(self, "matrix") and may_free(self.matrix):
            self.matrix.destroy()

    # --- compilation ---------------------------------------------------------------------------

    def _compile(self, potentials: dict[str, Any]) -> None:
        body, mesh = self.body, self.domain.mesh
        forms = derivatives(body, potentials, {k for k, e in self.effects.items() if e.outside})
        with together(list(forms.values())):
            self._forms = {name: compat.compile_form(mesh, form) for name, form in forms.items()}
        self.signatures = {name: form.signature() for name, form in forms.items()}
        self.kernels = sum(len(form.integrals()) for form in forms.values())
        self._assembler = Assembler(mesh.comm, self._forms["tangent"], body.space, body.ties)
        self.matrix = self._assembler.matrix
        self._couplings = {
            key: self._assembler.blocks(item.block_dofs) for key, item in self.discrete.items()
        }
        self._vector = compat.create_vector(self._forms["residual"])
        self._det_f = body.det_f()

    def place(self) -> Place:
        """Where the unknowns lie, at the present state."""
        return place(self.body, self.free)

    def fix(self, dofs: npt.NDArray[np.int32], values: Floats) -> None:
        """Fix further local dofs at given values, in mm (prescribed boundary displacement)."""
        self.free[dofs] = False
        self._fixed_values[dofs] = values
        self._fixed["prescribed"] = np.union1d(
            self._fixed.get("prescribed", np.zeros(0, dtype=np.int32)), dofs
        ).astype(np.int32)

    def hold(self, scalars: Mapping[str, float]) -> None:
        """Hold these natural scalars at given values, and no others: no kernel hangs on that.

        One that symmetry keeps at zero may be held there.
        """
        for name, value in scalars.items():
            if name in self.body.natural or not self.body.natural or value:
                self.set_scalar(name, value)
        kept = tuple(name for name in self.body.natural if name not in scalars)
        self.natural = (*kept, *self.added)

    def exchange(self, potentials: Mapping[str, Discrete]) -> None:
        """Take other potentials with own code of the same effects; a state is to be set then."""
        self._forget()
        self.discrete |= potentials

    # --- state ---------------------------------------------------------------------------------

    @property
    def w(self) -> Floats:
        """Coefficients of the fields that this rank owns, (owned,), a view."""
        values: Floats = self.body.w.x.array[: self.body.owned]
        return values

    def set(self, w: Floats) -> None:
        """Take the owned coefficients w, (owned,), as the state; fixed dofs take their values."""
        w = np.where(self.free[: self.body.owned], w, self._fixed_values[: self.body.owned])
        follow, lead = self.body.ties
        w[follow] = w[lead]
        if self._is_at(w):
            return
        self._forget()
        self._at = w
        self.w[:] = w
        self.body.w.x.scatter_forward()
        for discrete in self.discrete.values():
            discrete.update(self.body.w.x.array)

    def _is_at(self, w: Floats) -> bool:
        """Whether w is the state already; several ranks, which must agree, do not look."""
        at = self._at
        alone = self.domain.comm.size == 1
        return bool(alone and at is not None and np.all(at == w) and np.all(self.w == w))

    def _forget(self) -> None:
        self._at = None
        self._second.clear()
        self._loads.clear()

    def scalar(self, name: str) -> float:
        """Value of a global scalar."""
        return float(self.body.scalars[name].value)

    def set_scalar(self, name: str, value: float) -> None:
        """Set a global scalar."""
        if self.body.scalars[name].value != value:
            self._forget()
            self.body.scalars[name].value = value

    # --- the potential and its derivatives ---------------------------------------------------

    def det_f(self) -> float:
        """Least det F over the quadrature points of all ranks."""
        return self._det_f()

    @property
    def force_floor(self) -> float:
        """Least value of `force_scale`, N."""
        return self._force_floor

    def raise_force_floor(self, floor: float) -> None:
        """Let `force_scale` be no less than this from now on, N."""
        self._force_floor = max(self._force_floor, floor)

    def energies(self) -> dict[str, float]:
        """Π_e of every effect that has a potential, N mm, summed over all ranks."""
        comm, result = self.domain.comm, dict[str, float]()
        for key in self.keys:
            mine = 0.0
            if f"energy {key}" in self._forms:
                mine += compat.assemble_scalar(self._forms[f"energy {key}"])
            elif key not in self.discrete or self.effects[key].shares:
                continue
            if key in self.discrete:
                mine += self.discrete[key].energy()
            result[key] = float(total(comm, mine))
        return result

    def conjugate(self, name: str) -> float:
        """Work-conjugate −∂Π/∂q of a scalar q: the chamber volume in mm³ for the pressure."""
        form = self._forms.get(f"conjugate {name}")
        mine = 0.0 if form is None else -compat.assemble_scalar(form)
        mine += sum(discrete.conjugate(name) for discrete in self.discrete.values())
        return float(total(self.domain.comm, mine))

    def second_derivative(self, first: str, second: str) -> float:
        """∂²Π/∂q∂r of two global scalars at the present state."""
        if (first, second) in self._second:
            return self._second[first, second]
        mine = sum(discrete.second_derivative(first, second) for discrete in self.discrete.values())
        for key in (f"second {first} {second}", f"second {second} {first}"):
            if key in self._forms:
                mine += compat.assemble_scalar(self._forms[key])
                break
        value = float(total(self.domain.comm, mine))
        self._second[first, second] = value
        if self.conservative:
            self._second[second, first] = value
        return value

    def _sum(self, form: Any, add: Iterable[Callable[[Floats], None]]) -> tuple[Floats, float]:
        """Owned part of an assembled vector, and the norm of its discrete part."""
        vector = self._vector
        norm = 0.0
        with vector.localForm() as local:
            local.set(0.0)
            part = np.zeros(len(local.array_r))
            for fill in add:
                fill(part)
            norm = float(np.linalg.norm(part))
            local.array_w[:] = part
        if form is not None:
            compat.assemble_vector(vector, form)
        vector.ghostUpdate(PETSc.InsertMode.ADD_VALUES, PETSc.ScatterMode.REVERSE)
        values = vector.array_r.copy()
        follow, lead = self.body.ties
        np.add.at(values, lead, values[follow])
        values[follow] = 0.0
        return values, norm

    def _solid_noise(self) -> float:
        noise = probed(self.body, self._solid_forces)
        return self.norm(noise[self.free[: self.body.owned] & ~self.volumetric])

    def _solid_forces(self, w: Floats) -> Floats:
        """The residual without the potentials that have code of their own, owned part, (owned,)."""
        self.set(w)
        forces: Floats = self._sum(self._forms["residual"], ())[0]
        return forces + sum(map(self.force, self.outside))

    def residual(self) -> tuple[Floats, float]:
        """R = ∂Π/∂w at the present state.

        Returns:
            Its owned part (owned,), constrained dofs included: there it is the reaction; and a
            scale for the forces in it: the larger of reactions and fiber forces, or the floor.
        """
        r, norm = self._sum(
            self._forms["residual"], [item.add_residual for item in self.discrete.values()]
        )
        fixed = ~self.free[: self.body.owned]
        reaction = self.norm(r[fixed])
        discrete = float(np.sqrt(total(self.domain.comm, norm**2)))
        self.force_scale = max(reaction, discrete, self._force_floor)
        return r, self.force_scale

    def load(self, name: str, constrained: bool = False) -> Floats:
        """∂R/∂q of a scalar, (owned,); zero on constrained dofs unless these are wanted."""
        if name not in self._loads:
            fills = [functools.partial(item.add_load, name) for item in self.discrete.values()]
            self._loads[name], _ = self._sum(self._forms.get(f"load {name}"), fills)
        vector = self._loads[name]
        return vector.copy() if constrained else np.where(self.free[: len(vector)], vector, 0.0)

    def assemble_tangent(self, opposite: bool = False, free: Any = None) -> PETSc.Mat:
        """K = ∂R/∂w at the present state; unit diagonal on constrained dofs.

        Args:
            opposite: for displacements of the symmetry opposite to that of half a body.
            free: which dofs are, local, in place of those that are not constrained.
        """
        free = self.free if free is None else free
        if opposite:
            assert self.free_opposite is not None, "no symmetry halves the body"
            free = self.free_opposite
        self._second.clear()  # fibers may predict other forces now
        self._loads.clear()
        discrete = self.discrete.items()
        blocks = [(self._couplings[key], item.tangent_blocks()) for key, item in discrete]
        self._assembler.assemble(free, blocks)
        return self.matrix

    def norm(self, values: Floats) -> float:
        """Euclidean norm over all ranks of owned values."""
        return float(np.sqrt(total(self.domain.comm, float(values @ values))))

    def lag(self) -> Floats:
        """What a step with the last tangent lacks of the forces, owned part, (owned,), N."""
        if not self.discrete:
            return np.zeros(self.body.owned)
        vector = self._sum(None, [item.add_lag for item in self.discrete.values()])[0]
        return np.where(self.free[: len(vector)], vector, 0.0)

    @property
    def outside(self) -> list[str]:
        """Keys of the effects whose forces act from outside."""
        return [key for key in self.keys if f"force {key}" in self._forms]

    def force(self, key: str) -> Floats:
        """What an effect does to the body at the present state, −∂Π_e/∂w, owned part, N."""
        return -self._sum(self._forms[f"force {key}"], ())[0]

    @property
    def supports(self) -> list[str]:
        """Names of what fixes dofs."""
        return sorted(self._fixed)

    def fixed(self, name: str) -> npt.NDArray[np.int32]:
        """Local dofs that the constraints of this name fix, ghosts included, (n,)."""
        return self._fixed[name]
