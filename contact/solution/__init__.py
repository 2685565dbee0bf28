"""What comes out: the solution with its plan, as numbers, files, tables and pictures."""
