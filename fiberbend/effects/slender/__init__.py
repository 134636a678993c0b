"""What effects make of an actuator that is a rod."""
