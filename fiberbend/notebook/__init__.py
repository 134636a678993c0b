"""What a notebook shows: objects as blocks of HTML, and progress in its place."""
