"""Finite elements: kinematics, effects, Newton, march, measures."""

from fem import compat as compat  # before anything else loads dolfinx
