"""Strain energies of rubber, one file a law; `table` lists them."""
