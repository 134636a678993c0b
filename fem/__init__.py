"""Finite elements on dolfinx: kinematics, effects, scene, Newton, march and measures."""
