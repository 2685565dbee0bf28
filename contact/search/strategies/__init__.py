"""A context in, its contact out, or why this way to it was left: one way a file."""
