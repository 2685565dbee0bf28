"""Linear systems solved by the LU factors of their matrix."""

import numpy as np
import pytest

from sie.dense.lu import Factored


@pytest.mark.parametrize("size, columns", [(7, 3), (64, 8), (64, 40), (5, 0)])
def test_several_right_sides_together_have_the_solutions_of_each_alone(size, columns):
    rng = np.random.default_rng(size + columns)
    matrix, right = (
        rng.normal(size=(size, size)) + size * np.eye(size),
        rng.normal(size=(size, columns)),
    )
    factors = Factored.of(matrix)
    assert factors(right).shape == factors.transposed(right).shape == right.shape
    np.testing.assert_allclose(matrix @ factors(right), right, rtol=0, atol=1e-12)
    np.testing.assert_allclose(matrix.T @ factors.transposed(right), right, rtol=0, atol=1e-12)
    for solved, column in zip(factors(right).T, right.T, strict=True):
        np.testing.assert_allclose(solved, factors(column), rtol=0, atol=1e-14)
