"""What is measured of the package: error against run time, extremes, random scenes, traces."""
