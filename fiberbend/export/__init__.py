"""A rod's numbers for other programs: rest strains and stiffness by pressure, masses, geometry."""
