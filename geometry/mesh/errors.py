"""Errors of mesh building."""


class MeshError(RuntimeError):
    """A mesh could not be built, or what was built is not the body that was asked for."""
