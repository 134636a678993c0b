"""`python -m fiberbend` is the command `fiberbend`."""

from fiberbend.cli import entry

if __name__ == "__main__":
    entry()
