"""The scaled problem of a scene, and approximate zones of its contact, found on grids."""
