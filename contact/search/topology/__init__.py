"""Correction of proposed zones or gaps until pressure and gap have the right signs everywhere."""
