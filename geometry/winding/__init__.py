"""The fibers' helices and how they lie in the faces of elements."""
