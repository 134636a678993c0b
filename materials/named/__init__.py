"""Materials by name, each with the source of its numbers; `table` lists them."""
