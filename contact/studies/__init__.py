"""Studies of the package: error against run time, extreme and random scenes, ablation."""
