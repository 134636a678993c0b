"""Files of tests of rubber: their columns, units and cycles."""
