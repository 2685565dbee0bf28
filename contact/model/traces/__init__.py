"""Measured traces: reading, checking and preparing the points of a profile."""
