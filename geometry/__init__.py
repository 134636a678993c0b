"""Dimensions, section blocks, meshes and fiber curves of the actuator. A leaf: no FEniCSx here.

Part of fiberbend.
"""
