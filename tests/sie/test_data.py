"""Functions that work on a table in blocks of rows give the result for the whole table."""

import numpy as np

from sie.basis.data import by_rows, row_sizes


def test_rows_in_parts_are_those_of_the_whole_table():
    table = np.random.default_rng(0).normal(size=(5000, 3))
    assert np.array_equal(row_sizes(table), np.abs(table).max(axis=1))
    assert np.array_equal(row_sizes(table[:, :0]), np.zeros(5000))
    assert np.array_equal(
        by_rows(lambda one, two: (one * two).sum(axis=1), table, table + 1),
        (table * (table + 1)).sum(axis=1),
    )
