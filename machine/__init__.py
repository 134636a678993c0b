"""The computer that a run finds: folders that can be trusted, processor, BLAS, and commit.

Part of fiberbend.
"""
