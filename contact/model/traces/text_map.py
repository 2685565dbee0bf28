"""A line of a map that a text file gives as rows of x, y and z.

The points must lie on a grid with even distances in x and in y, in any order. Points that the file
leaves out count as not measured.
"""

from typing import Any

import numpy as np

from contact.model.traces.file import Table, in_metres, read_table
from contact.model.traces.instruments import of_map
from contact.model.traces.text import Source, at
from sie import Array

# Largest deviation of a coordinate from an even grid, divided by the spacing of the grid. It allows
# for the rounding of coordinates that are printed with two digits more than the spacing needs.
_UNEVEN = 0.01


def read_map(
    path: Source, line: Any, along: Any, units: Any, **layout: Any
) -> tuple[Array, Array, str, Table]:
    """(positions [m], heights [m], text, table) for one line of a map.
    The text names the units of the file and the line; the table is the content of the file.

    layout: arguments of `read_table`. Missing heights are NaN.
    """
    table = read_table(path, wanted=3, **layout)
    values, said = in_metres(path, table, units)
    (x, i), (y, j) = (_grid(path, name, values[:, k], table) for k, name in enumerate("xy"))
    heights = np.full((len(x), len(y)), np.nan)
    number = i * len(y) + j
    again = np.flatnonzero(np.bincount(number, minlength=1) > 1)
    if len(again):
        second = np.flatnonzero(number == again[0])[1]
        raise at(
            path,
            table.lines[second],
            "this line repeats the point (x, y) of an earlier line; remove one",
        )
    heights[i, j] = values[:, 2]
    pitches = [(far[-1] - far[0]) / (len(far) - 1) for far in (x, y)]
    sizes = pitches[0] * len(x), pitches[1] * len(y)
    position, height, where = of_map(heights, sizes, line, along)
    return position, height, f"{said}, {where}", table


def _grid(path: Source, name: str, places: Array, table: Table) -> tuple[Array, Array]:
    """(coordinates of the grid in one direction, index of each point in these coordinates)."""
    grid, index = np.unique(places, return_inverse=True)
    if len(grid) < 2:
        raise at(path, table.lines[0], f"a map needs at least two values of {name}")
    even = np.linspace(grid[0], grid[-1], len(grid))
    unevenness = np.abs(grid - even)
    if unevenness.max() > _UNEVEN * (even[1] - even[0]):
        # A coordinate that is not on the grid usually has the fewest points.
        rare = int(np.argmin(np.bincount(index.ravel())))
        row = table.lines[int(np.argmax(index == rare))]
        what = f"the values of {name} are not evenly spaced, for example at {grid[rare]:.6g} m"
        raise at(
            path, row, f"{what}; interpolate the map to an even grid, or export one line of it"
        )
    return grid, np.asarray(index)
