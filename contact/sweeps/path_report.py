"""A load path as text: its numbers at each value of the control, and its events, with units."""

import textwrap
from collections.abc import Sequence

import numpy as np

from contact.model.units import headed, quantity, text_table
from contact.solution.report import heading, is_apart, label, title
from contact.solution.solution import Solution
from contact.sweeps.adhesive import AdhesivePath
from contact.sweeps.path_table import Event, columns
from contact.sweeps.paths import Path
from contact.sweeps.points import NUMBERS

Column = tuple[str, list[str]]

# Quantities in the table, each with its number of significant digits.
_SHOWN = {
    "load": 4,
    "mean_pressure": 4,
    "max_pressure": 4,
    "approach": 4,
    "contact_fraction": 4,
    "total_width": 4,
    "mean_gap": 4,
    "stiffness": 4,
    "zone_count": 5,
    "error": 2,
}
# Columns that are dropped, in this order, until the table is narrow enough. Other columns tell
# nearly the same.
_SPARE = ("mean_gap", "mean_pressure", "stiffness", "load")


def value_columns(found: Path) -> dict[str, Column]:
    """Columns (header, cells) of a path by name, with a row for each value of the control.

    If surfaces adhere, the column of the control has the given values and not those of the
    solutions, since separated surfaces do not bear a given load. With a spring, the given values
    have a separate column.
    """
    known: dict[str, list[float]] = columns(found.solutions)
    apart = np.array([is_apart(solution) for solution in found.solutions])
    heads = {name: heading(name) for name in NUMBERS}
    shown = [name for name in _SHOWN if not np.isnan(known[name]).all()]
    if "contact_fraction" in shown:
        shown.remove("total_width")
    table = {}
    if isinstance(found, AdhesivePath):
        values = found.values.tolist()
        if found.stiffness is None:
            known[found.control] = values
            heads[found.control] = heading(f"given {found.control}")
        else:
            table["far_end"] = headed("spring's\nfar end", values, "m", _SHOWN["approach"])
    for name in shown:
        if name == "zone_count":
            table[name] = (heads[name], [_zones(solution) for solution in found.solutions])
        else:
            # The gap of surfaces that are apart under a load is infinite. The table says only that
            # they are apart, in the column of the zones.
            values = np.array(known[name], dtype=float)
            cells = np.where(apart & np.isinf(values), np.nan, values).tolist()
            table[name] = headed(heads[name], cells, NUMBERS[name][0], _SHOWN[name])
    return table


def _zones(solution: Solution) -> str:
    return "apart" if is_apart(solution) else str(len(solution.zones) or "full")


def event_columns(events: Sequence[Event]) -> list[Column]:
    """Columns (header, cells) of the events of a path; the first and the last are words."""
    numbers: list[tuple[str, list[float | None], str, int]] = [
        ("load", [event.load for event in events], "N/m", 10),
        ("position", [event.position for event in events], "m", 7),
    ]
    if any(hasattr(event, "lost") for event in events):
        lost = [getattr(event, "lost", None) for event in events]
        numbers.append(("energy lost", lost, "J/m", 6))
    cells = [(head.replace("\n", " "), text) for head, text in (headed(*n) for n in numbers)]
    return [
        ("event", [event.kind for event in events]),
        *cells,
        ("zones", [event.change() for event in events]),
    ]


def energy_line(found: Path) -> str:
    """The energy lost on a path and the work of the load; empty if they are not known."""
    if not (isinstance(found, AdhesivePath) and found.events) or found.dissipated is None:
        return ""
    lost, work = quantity(found.dissipated, "J/m"), quantity(found.work, "J/m")
    return f"energy lost in all jumps: {lost}; work of the load: {work}"


def report(found: Path) -> str:
    """The path as text, at most 80 columns wide: a row for each value, then the events."""
    table, left_out = value_columns(found), []
    text = text_table(table.values(), words=(), blanks=1)
    for name in _SPARE:
        if name in table and _width(text) > 80:
            del table[name]
            left_out.append(label(name))
            text = text_table(table.values(), words=(), blanks=1)
    parts = [*textwrap.wrap(title(found.solutions[0].scene), 80), "", text]
    if left_out:
        parts.append(f"left out (too wide; see save()): {', '.join(left_out)}")
    if found.events:
        events = event_columns(found.events)
        parts += ["", text_table(events, words=(0, len(events) - 1))]
    if line := energy_line(found):
        parts.append(line)
    return "\n".join(parts)


def _width(text: str) -> int:
    return max(map(len, text.splitlines()))


def summary(found: Path) -> str:
    """One line: how many solutions a path has, for which values, and how many events."""
    control, values = "load", found.loads
    if isinstance(found, AdhesivePath):
        control, values = found.control, found.values
    low, high = (quantity(float(end), NUMBERS[control][0]) for end in (values.min(), values.max()))
    return (
        f"<{type(found).__name__}: solutions: {len(values)}, {label(control)}: {low} to {high}, "
        f"events: {len(found.events)}>"
    )
