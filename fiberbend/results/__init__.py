"""A run as it lies in its folder: names of its files, writing and reading them."""
