"""Closed-form solutions of scenes with one symmetric zone of contact."""
