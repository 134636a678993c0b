"""Laws of sections about their free states: of those that twist or bend to the side."""
