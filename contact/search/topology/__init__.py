"""Intervals and a formulation in, intervals whose signs are right out: for zones and gaps alike."""
