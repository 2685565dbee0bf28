"""One hypothesis profile for all tests: the same examples on every machine. Tests that run side by side take one thread each."""

import os

from hypothesis import settings

if "PYTEST_XDIST_WORKER" in os.environ:  # before numpy is loaded
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")

settings.register_profile("ci", derandomize=True, deadline=None, max_examples=25, database=None)
settings.load_profile("ci")
