"""How stiff rubber is against bulging between the turns of a winding, from the cell of a case."""
