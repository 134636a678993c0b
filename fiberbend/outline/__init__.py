"""The outer surface of an actuator as a rod touches obstacles with it."""
