"""Pressures of tetrahedra: continuous within a region, with a jump from one to the next."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem import compat
from fem.kinematics.domain import Domain


def continuous_by_region(domain: Domain, space: Any, field: int) -> Any:
    """A mixed space in which elements of one region share the dofs of a field at a vertex.

    Between rubbers of unequal stiffness, and where a winding pulls on the face between two regions,
    the pressure jumps. A continuous one, as Taylor–Hood's pair has it in one body, is wrong in
    every element that touches such a face: in thin walls in all of them.

    A dof is owned by the first rank that has an element with it, and stands where the first of the
    elements' own dofs stood that it replaces.

    Args:
        domain: the mesh, of tetrahedra.
        space: mixed space in which the field is P1 with dofs of each element's own.
        field: number of the field in the space.
    """
    comm, data = domain.comm, domain.data
    rows, own = compat.cell_dofs(space), compat.field_dofs(space, field)
    owned = compat.owned_dofs(space)
    corners = data.cells[domain.cells][:, compat.node_permutation(data.cell_type)[:4]]
    numbers = corners * (max(data.regions.values()) + 1) + data.cell_region[domain.cells][:, None]
    names, which = np.unique(numbers, return_inverse=True)
    which = which.reshape(own.shape)
    first = np.full(len(names), owned, dtype=np.int32)
    np.minimum.at(first, which.ravel(), own.ravel())

    everywhere = comm.allgather(names)
    owner = np.full(len(names), comm.rank, dtype=np.int32)
    for rank in reversed(range(comm.rank)):
        owner[np.isin(names, everywhere[rank])] = rank
    mine, others = owner == comm.rank, np.flatnonzero(owner != comm.rank)

    kept = np.ones(owned, dtype=bool)
    kept[own] = False
    kept[first[mine]] = True
    count = int(kept.sum())
    before = sum(comm.allgather(count)[: comm.rank])
    old_owners = compat.ghost_owners(space)
    ghosts = len(old_owners)
    local = np.zeros(owned + ghosts, dtype=np.int32)
    local[:owned] = np.cumsum(kept) - 1
    local[owned:] = count + np.arange(ghosts)
    old_numbers = compat.from_owners(space, before + local[:owned])

    shared = local[first]
    theirs = comm.allgather((names[mine], before + shared[mine]))
    shared[others] = count + ghosts + np.arange(len(others))
    local[own] = shared[which]
    new_numbers = np.zeros(len(names), dtype=np.int64)
    for rank in np.unique(owner[others]):
        here = owner == rank
        new_numbers[here] = theirs[rank][1][np.searchsorted(theirs[rank][0], names[here])]
    return compat.shared_space(
        space,
        local[rows],
        count,
        np.r_[old_numbers, new_numbers[others]],
        np.r_[old_owners, owner[others]],
    )
