"""Friction of contacts that stick in part: solutions come in, shear, stick and slip go out."""
