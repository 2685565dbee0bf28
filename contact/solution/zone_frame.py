"""`ZoneFrame`: a pandas table that prints small lengths with all their digits."""

from typing import Any

import pandas


class ZoneFrame(pandas.DataFrame):
    """A pandas.DataFrame that prints numbers with six significant digits.

    pandas itself prints six decimals, so that 8.6e-6 m would be shown as 0.000009.
    """

    @property
    def _constructor(self) -> type:
        return ZoneFrame

    def __repr__(self) -> str:
        with _digits():
            return str(super().__repr__())

    def _repr_html_(self) -> str | None:
        with _digits():
            text: str | None = super()._repr_html_()
            return text


def _digits() -> Any:
    """Context in which pandas prints numbers with six significant digits."""
    return pandas.option_context("display.float_format", "{:.6g}".format)
