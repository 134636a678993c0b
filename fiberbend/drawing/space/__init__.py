"""Pictures in space: pages of panels, obstacles, an actuator at rest and in motion."""
