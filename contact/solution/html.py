"""A solution in a notebook: its numbers as a table, and its figure where matplotlib is installed."""

import base64
import io
from html import escape

from contact.errors import MissingExtra
from contact.model.units import quantity
from contact.solution.answer import Answer
from contact.solution.plotting import plot


def to_html(solution: Answer) -> str:
    """Numbers with their units, the stated error, what the certificate says, and the figure as a picture within the page."""
    checked = solution.certificate.to_dict()
    rows = [
        ("zones", str(len(solution.zones))),
        ("load", quantity(solution.load, "N/m")),
        ("largest pressure", quantity(solution.max_pressure, "Pa")),
        ("mean pressure", _if_any(solution.mean_pressure, "Pa")),
        ("approach", _if_any(solution.approach, "m")),
        ("contact fraction", "" if solution.contact_fraction is None else f"{solution.contact_fraction:.6g}"),
        ("stated error", f"{solution.error:.1e}"),
        ("certificate", "holds" if checked["holds"] else f"does not hold: {checked['note']}"),
    ]
    lines = "".join(f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in rows if value)
    return f"<table>{lines}</table>{_picture(solution)}"


def _if_any(value: float | None, unit: str) -> str:
    return "" if value is None else quantity(value, unit)


def _picture(solution: Answer) -> str:
    stream = io.BytesIO()
    try:
        plot(solution).savefig(stream, format="png", dpi=96)
    except MissingExtra as error:
        return f"<p>{escape(str(error))}</p>"
    return f'<img alt="surfaces and pressure" src="data:image/png;base64,{base64.b64encode(stream.getvalue()).decode()}">'
