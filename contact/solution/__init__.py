"""The solution and its plan, and their output as numbers, files, tables and figures."""
