"""The command `fiberbend control`."""
