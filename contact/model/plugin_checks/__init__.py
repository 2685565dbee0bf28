"""Checks of the parts of a scene that a user wrote: a part comes in, its faults go out."""
