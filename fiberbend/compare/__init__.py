"""A run beside other models and measured points."""
