"""Commands that `fiberbend.cli` loads when they are called, a file each."""
