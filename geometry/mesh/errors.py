"""Errors of mesh building."""

NO_MESH = 3
"""Exit code of the process of gmsh where gmsh found no mesh."""


class MeshError(RuntimeError):
    """A mesh could not be built, or what was built is not the body that was asked for."""
