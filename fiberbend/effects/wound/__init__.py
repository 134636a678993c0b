"""What a winding is made of: threads, families of them, and how they are checked."""
