"""Tables of a smooth kernel of the lag x - xi, and the modes needed by a kernel of a declared
length.
"""

import numpy as np
import pytest

import sie
from sie.basis.lag_table import LagTable


@pytest.mark.parametrize("length", [1e-3, 0.1, 3.0])
def test_a_table_gives_the_kernel_to_rounding(length):
    def kernel(x, xi):
        return (x - xi) / ((x - xi) ** 2 + length**2)

    table = LagTable.of(kernel, 2.0, length)
    lag = np.concatenate(
        (np.linspace(-2.0, 2.0, 999), np.clip(length * np.linspace(-3.0, 3.0, 99), -2.0, 2.0))
    )
    assert np.abs(table(lag) - kernel(lag, 0.0)).max() < 4e-15 / length


def test_a_kernel_that_varies_over_less_than_its_declared_length_has_no_table():
    assert LagTable.of(lambda x, xi: 1 / ((x - xi) ** 2 + 1e-4), 2.0, 1.0) is None


@pytest.mark.parametrize("length", [1e-1, 1e-2, 1e-3])
def test_modes_of_a_smooth_kernel_grow_as_the_root_of_the_width_over_its_length(length):
    kernel = sie.cauchy() + sie.Smooth(
        lambda x, xi: (x - xi) / ((x - xi) ** 2 + length**2), of_lag=True, length=length
    )
    state = sie.solve_fixed(
        sie.Equation(kernel, sie.Forcing(lambda x: x), (sie.Total(1.0),)),
        sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR),
    )
    assert state.unknowns.size < 60 / np.sqrt(length) and state.density_error < 1e-8
