"""Figure of a sweep: results against one varied key, with a line for each value of another key.

The abscissa is the key with numeric values or, if both keys have them, the key with more values. If
no key has numeric values, the abscissa has words at even distances. Failed points are missing.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.solution.drawing import (
    SURFACE,
    finish,
    is_geometric,
    legend_outside,
    panels,
    ramp,
    unit_of,
)
from contact.solution.report import label
from contact.sweeps.points import NUMBERS
from sie import Array

_DASHES: tuple[Any, ...] = ("-", (0, (6, 2)), (0, (2, 1)), (0, (6, 2, 1, 2)))
_MARKERS = "os^Dv"
_DEFAULT = ("max_pressure", "contact_fraction", "total_width")


def check_drawable(sizes: Mapping[str, int]) -> None:
    """Raise SceneError if more than two keys have several values.
    sizes: the number of values of each key.
    """
    several = [key for key, size in sizes.items() if size > 1]
    if len(several) > 2:
        allowed = (
            f"left out: {', '.join(several)} have several values, and a figure shows at most two "
            "such keys"
        )
        raise SceneError.of("--plot", "given", allowed)


def plot_sweep(table: Any, names: Sequence[str] = ()) -> Any:
    """A matplotlib figure with a panel for each number.

    table: xarray.Dataset of a sweep. names: names of the numbers; by default the largest pressure
    and the contact fraction, or the width in contact if there is no period.
    """
    check_drawable(table.sizes)
    shown = list(names) or [name for name in _DEFAULT if table[name].notnull().any()][:2]
    several = [key for key in table.dims if table.sizes[key] > 1] or list(table.dims)[:1]
    # The abscissa shows a key with numeric values if there is one, and otherwise a key with words.
    several.sort(key=lambda key: (table[key].dtype.kind in "iuf", table.sizes[key]), reverse=True)
    across, *others = several
    fixed = {key: 0 for key in table.dims if key not in several}
    figure, axes = panels(None, len(shown))
    for panel, name in zip(axes, shown, strict=True):
        values = table[name].isel(fixed).transpose(across, *others).values
        lines = values.reshape(len(table[across]), -1).T
        _draw(panel, table, (across, *others), name, lines)
    legend_outside(figure, axes)
    failed = int(table["failed"].sum())
    caption = [f"{_name(table, key)} {_value(table, key, 0)}" for key in fixed]
    caption += [f"{failed} of {table['failed'].size} points failed"] if failed else []
    figure.supxlabel(", ".join(caption), fontsize=9)
    return figure


def _draw(axes: Any, table: Any, keys: Sequence[str], name: str, lines: Array) -> None:
    """Draw one computed quantity of a sweep, such as the load.
    lines: values of the quantity, with a row for each value of the second key.
    """
    across, *others = keys
    x, below, log = _abscissa(axes, table, across)
    known = lines[np.isfinite(lines)]
    log_up = log and bool(np.all(known > 0.0)) and name != "zone_count"
    unit = NUMBERS[name][0].removeprefix("1")
    up, named = unit_of(known, unit, log_up) if unit else (1.0, "")
    axes.set(xscale="log" if log else "linear", yscale="log" if log_up else "linear")
    colours = ramp(len(lines)) if others else [SURFACE]
    for place, (values, colour) in enumerate(zip(lines, colours, strict=True)):
        style: dict[str, Any] = {"color": colour, "linestyle": _DASHES[place % len(_DASHES)]}
        marker = _MARKERS[place % len(_MARKERS)]
        if len(x) <= 30:
            style |= {"marker": marker, "markersize": 4, "markerfacecolor": "none"}
        own = f"{_name(table, others[0])} {_value(table, others[0], place)}" if others else None
        shown = np.where(np.isfinite(values), values, np.nan)
        axes.plot(x, shown * up, linewidth=1.4, label=own, **style)
    head = label(name)
    axes.grid(alpha=0.25)
    finish(axes, below, f"{head} [{named}]" if unit else head, legend=False)


def _abscissa(axes: Any, table: Any, key: str) -> tuple[Array, str, bool]:
    """(positions of a key's values on the abscissa, label, whether the abscissa is logarithmic)."""
    values = table[key].values
    if values.dtype.kind not in "iuf":
        axes.set_xticks(range(len(values)), [str(value) for value in values])
        return np.arange(len(values), dtype=float), _name(table, key), False
    log = is_geometric(values)
    unit = table[key].attrs.get("units", "").removeprefix("1")
    factor, named = unit_of(values, unit, log) if unit else (1.0, "")
    name = _name(table, key)
    return values * factor, f"{name} [{named}]" if unit else name, log


def _name(table: Any, dimension: str) -> str:
    """The label of a key: its name without the table, if no other varied key has this name."""
    keys = [table[name].attrs["key"] for name in table.dims]
    key = table[dimension].attrs["key"]
    short = key.rpartition(".")[2]
    alone = sum(other.rpartition(".")[2] == short for other in keys) == 1
    return label(short) if alone else key


def _value(table: Any, key: str, place: int) -> str:
    """One value of a key as text, in the unit that all its values have."""
    values = table[key].values
    if values.dtype.kind not in "iuf":
        return str(values[place])
    unit = table[key].attrs.get("units", "").removeprefix("1")
    factor, named = unit_of(values, unit, is_geometric(values)) if unit else (1.0, "")
    return f"{values[place] * factor:.4g} {named}".strip()
