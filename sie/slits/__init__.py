"""Zones with narrow gaps: wide zones with slits, the same equation and the same density."""
