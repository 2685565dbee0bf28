"""Sums over many intervals in linear time: trees, far sums, GMRES, hierarchical inverses."""
