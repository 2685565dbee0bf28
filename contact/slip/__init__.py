"""Partial slip and rolling: shear, stick zones and slip zones of contacts with friction."""
