"""What a design tells of its answer: words, tables, pictures, files."""
