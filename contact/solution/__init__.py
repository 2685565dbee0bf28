"""The solution with its plan, as numbers, files, tables and figures."""
