"""Motion that a case asks for: what it says of time, files of pressures, and checks."""
