"""The same tests everywhere: one hypothesis profile, names that no process makes otherwise, one
thread for each of those side by side.
"""

from __future__ import annotations

import os
import re
import sys
import warnings
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import settings

if "PYTEST_XDIST_WORKER" in os.environ:
    # numpy reads these variables only when it is loaded, so it must not be loaded before. The
    # filter of warnings is set in `pytest_configure`, because in pyproject.toml it would import
    # numpy.
    if "numpy" in sys.modules:
        warnings.warn(
            "numpy was loaded before conftest.py: every process uses every core, and the tests are slow",
            stacklevel=1,
        )
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")


def pytest_configure(config: pytest.Config) -> None:
    """Register the hypothesis profile, and ignore `contact.ModelWarning`.

    If the slow tests are left out, each property is tested with fewer examples. The warning is
    ignored because some tests solve shapes with steeper slopes than the model allows.
    """
    config.addinivalue_line("filterwarnings", "ignore::contact.ModelWarning")
    count = 10 if config.getoption("markexpr") == "not slow" else 60
    settings.register_profile(
        "ci", derandomize=True, deadline=None, max_examples=count, database=None
    )
    settings.load_profile("ci")


@pytest.fixture
def newton_steps(monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[[], Any]], Any]:
    """Function that returns the number of Newton steps in a call, and the result of the call."""
    # This import loads numpy, so it must come after the thread limits above.
    from sie.ends import newton

    count, real = [0], newton.solve_zones

    def counted(*arguments: Any, **options: Any) -> Any:
        count[0] += 1
        return real(*arguments, **options)

    monkeypatch.setattr(newton, "solve_zones", counted)

    def of(call: Callable[[], Any]) -> Any:
        count[0] = 0
        result = call()
        return count[0], result

    return of


def pytest_make_parametrize_id(config: pytest.Config, val: Any, argname: str) -> str | None:
    """Name bytes, long texts and long numbers in test ids by their argument.

    The ids must not change from run to run, and packed files contain the time.
    """
    text = isinstance(val, str) and len(val) > 60
    return (
        argname
        if text or isinstance(val, bytes) or (type(val) is int and abs(val) > 10**18)
        else None
    )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Refuse test ids that contain an address: parallel processes must agree on all ids."""
    for item in items:
        if re.search(r" at 0x[0-9a-f]+", item.nodeid):
            raise pytest.UsageError(f"{item.nodeid}: its name has an address in it; give it an id")
