"""Localized contact: in, a scene whose interaction has a strip; out, the zones of that strip."""
