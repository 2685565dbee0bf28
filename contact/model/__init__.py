"""Scenes: profile, material, interaction and control come in, a checked scene goes out."""
