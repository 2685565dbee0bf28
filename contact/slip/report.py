"""A `Slip` as text: its numbers with units and stated errors, and its stick and slip zones."""

import textwrap
from collections.abc import Iterator

import numpy as np

from contact.inside.field import unit_pressure
from contact.model.units import headed, quantity, text_table, with_error
from contact.slip.export import INTERVAL_COLUMNS, interval_table
from contact.slip.result import Slip
from contact.solution.report import (
    HEADS,
    Errors,
    Row,
    given_or_found_load,
    title,
    total_width,
    zone_count,
)


def heading(slip: Slip) -> str:
    """One line of text with the model of friction and the names of the parts of the scene."""
    return f"{slip.model}, {title(slip.solution.scene)}"


def numbers(slip: Slip) -> Iterator[Row]:
    """(name, value, error bound) as text, for each result of a solution with friction."""
    solution, scene = slip.solution, slip.solution.scene
    yield "E*", quantity(scene.E_star, "Pa", 10), "given"
    given, errors = scene.given_load is not None, Errors(solution)
    text, bound = with_error(given_or_found_load(solution), 0.0 if given else errors.load, "N/m")
    yield "load", text, "given" if given else bound
    pressure = slip.error * slip.friction * unit_pressure(solution.fields)
    pulled = slip.model == "partial slip"
    error = 0.0 if pulled else 3 * pressure * total_width(solution)
    text, bound = with_error(slip.tangential_load, error, "N/m")
    yield "tangential load", text, "given" if pulled else bound
    yield "friction", f"{slip.friction:.10g}", "given"
    if slip.bulk_stress:
        yield "bulk stress", quantity(slip.bulk_stress, "Pa", 10), "given"
    if slip.creepage is not None:
        yield "creepage", f"{slip.creepage:.10g}", "-"
    if slip.shift is not None:
        yield "shift", *with_error(slip.shift, slip.shift_error, "m")
    if slip.dissipated is not None:
        yield "lost energy", *with_error(slip.dissipated, slip.dissipated_error, "J/m")
    yield "zones", zone_count(solution), ""
    for name, table in (("stick zones", slip.stick_zones), ("slip zones", slip.slip_zones)):
        width = float(np.diff(table).sum())
        yield name, f"{len(table)}, {quantity(width, 'm', 7)} in total" if width else "0", ""
    yield "stated error", "", f"{slip.error:.2g}"


def zone_columns(slip: Slip, most: int = 10) -> list[tuple[str, list[str]]]:
    """Columns (header, cells) of the stick and slip zones.
    If there are more than `most` zones, the widest are listed.
    """
    rows = interval_table(slip)
    widest = np.argsort([-row[2] for row in rows], kind="stable")[:most]
    shown = [rows[k] for k in np.sort(widest).tolist()]
    if not shown:
        return []
    *ends, states = zip(*shown, strict=True)
    named = zip(INTERVAL_COLUMNS[:3], ends, strict=True)
    return [("state", list(states)), *(headed(name, values, "m", 9) for name, values in named)]


def report(slip: Slip, most: int = 10) -> str:
    """The solution with friction as text, at most 80 columns wide.
    If there are more than `most` stick and slip zones, the widest are listed.
    """
    rows = zip(*numbers(slip), strict=True)
    parts = [*textwrap.wrap(heading(slip), 80), "", text_table(list(zip(HEADS, rows, strict=True)))]
    if columns := zone_columns(slip, most):
        parts += ["", text_table(columns)]
    if (more := len(slip.stick_zones) + len(slip.slip_zones) - most) > 0:
        parts.append(f"the {most} widest zones; {more} more in zone_table()")
    return "\n".join(parts)
