"""Cases of a design solved by section, cell and body."""
