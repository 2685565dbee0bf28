"""The solution of a scene: its numbers and fields, and its ways out as tables, files and pictures."""

from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np

from contact.extras import require
from contact.model.controls import Quantity
from contact.solution.answer import Answer
from contact.solution.validity import everything

# Loaded by those who ask for them.
_PICTURES = "contact.solution.plotting"
_FILES = "contact.solution.export"


@dataclass(frozen=True, eq=False)
class Solution(Answer):
    """Zones (n, 2) [m], pressure and gap anywhere, loads per unit thickness [N/m]; made by
    `contact.solve`.

    What follows from `error` for each number is stated with it, p being the peak pressure (the mean
    contact pressure where the peak is infinite); see docs/errors.md.

    Parameters
    ----------
    scene : Scene
        What was asked.
    zones : ndarray
        Zone ends [m], (n, 2), ascending; with a period, left ends in [x0, x0 + L); (0, 2) in full
        contact.
    fields : Fields
        What the methods below ask.
    error : float
        Stated bound of (i) the pressure's error at equal normalised position in corresponding zones
        over p, and (ii) each end's error over its zone's width.
    certificate : Certificate
        What was checked on the whole line, and the values.
    plan : Plan
        What ran, what was left out and why, and the times.
    trace : tuple
        The Newton steps.
    branch : str or None
        Where a law has several equilibria, how this one was come by: "advancing", the control
        raised to its value, or "receding", it was lowered to it; the plan says from where. None
        under other laws, and where the zones are given.
    parting : callable or None
        What tells where such a contact comes apart.

    Examples
    --------
    >>> import contact
    >>> scene = contact.Scene(contact.Parabola(radius=1.0), 1e9, contact.Isolated(datum=1.0), load=1e4)
    >>> solution = contact.solve(scene)
    >>> solution.zones.round(9).tolist()
    [[-0.003568248, 0.003568248]]
    >>> solution.pressure([0.0, 1.0]).round(-3).tolist(), solution.gap(0.0).tolist()
    ([1784000.0, 0.0], 0.0)
    """

    @cached_property
    def warnings(self) -> list[str]:
        """What the model hardly covers: slopes, pressures, a modulus, a trace; given out as
        ModelWarnings too.
        """
        return everything(self)

    def plot(self) -> Any:
        """The surfaces and the pressure, as a matplotlib figure of its own; MissingExtra without
        matplotlib.
        """
        return require(_PICTURES).plot(self)

    def to_dataset(self) -> Any:
        """Zones, fields and numbers as an xarray.Dataset with units; MissingExtra without xarray."""
        return require(_FILES).to_xarray(self)

    def _repr_html_(self) -> str:
        return require(_PICTURES).to_html(self)

    def zone_table(self) -> Any:
        """left, right, width [m], load [N/m], mean_pressure, max_pressure [Pa] of each zone: a
        pandas.DataFrame where pandas is installed, else a dictionary of an array for each column.
        """
        return require(_FILES).zone_frame(self)

    def save(self, path: str | PathLike[str], overwrite: bool = False) -> None:
        """Write zones, numbers and scene as JSON, or those and the fields as netCDF: .json or .nc
        says which.

        Raises
        ------
        SceneError
            If the name ends otherwise, or the file is there and `overwrite` is not given.
        """
        files = require(_FILES)
        file = files.new_file(path, overwrite, (".json", ".nc"))
        write = files.write_json if file.suffix.lower() == ".json" else files.write_netcdf
        write(self, file, overwrite)

    def save_zones(self, path: str | PathLike[str], overwrite: bool = False) -> None:
        """Write the zone table as CSV, SI, in full precision; a file that is there only with
        `overwrite`.
        """
        require(_FILES).write_csv(self, path, overwrite)

    def save_fields(self, path: str | PathLike[str], overwrite: bool = False) -> None:
        """Write x, pressure, gap, displacement, profile as CSV, SI, in full precision; a file that
        is there only with `overwrite`.
        """
        require(_FILES).write_fields(self, path, overwrite)

    def to_dict(self) -> dict[str, Any]:
        """All of it in plain types; None for what is infinite or undefined."""
        return require(_FILES).to_dict(self)


def limit_of_approach(solution: Solution, tol: float) -> str:
    """That the digits of a given approach keep the load from being known to `tol`, in words; empty
    where they do not.

    Near full contact the approach is the mean of the profile less a mean gap that goes with the
    square of narrow gaps over kinks, with the fourth power of others: the load hangs on the last
    digits of what is given.
    """
    approach, stiffness = solution.scene.held(Quantity.APPROACH), solution.stiffness
    if approach is None or stiffness is None or not np.isfinite(stiffness):
        return ""
    condition = abs(approach * stiffness / solution.load)
    rounding = float(np.finfo(np.float64).eps) * condition
    if rounding <= 0.1 * tol:
        return ""
    return (
        f"a unit in the last digit of the approach is {rounding:.1e} of the load (condition {condition:.0e}): give a load, a mean "
        "pressure or a contact fraction"
    )
