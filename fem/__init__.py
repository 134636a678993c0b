"""Finite elements: kinematics, effects, Newton, march, measures.

Part of fiberbend.
"""

from fem import quick_start as quick_start  # before anything else loads PETSc or dolfinx

quick_start.start_petsc()

from fem import compat as compat  # noqa: E402
