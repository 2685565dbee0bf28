"""From a scene to its scaled problem and to about where its zones are, by contacts on grids."""
