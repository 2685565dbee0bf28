"""Tangential loads. A context comes in, contacts that slide go out."""
