"""The Python interface: functions and what they return."""
