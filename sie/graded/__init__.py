"""Zones beside narrow gaps, with a coordinate that is graded towards the gaps."""
