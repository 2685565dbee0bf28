"""One interval: its ends, the weighted Chebyshev functions on it, and the kernels."""
