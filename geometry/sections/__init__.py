"""Cross-sections: their outlines and block-structured quads."""
