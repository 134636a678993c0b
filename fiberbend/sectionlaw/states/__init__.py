"""States of a section whose strains are held: one, many, and the box that they fill."""
