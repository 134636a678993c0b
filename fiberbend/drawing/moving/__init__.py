"""Pictures of what moves: a motion over time, and modes of vibration."""
