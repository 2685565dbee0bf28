"""A solution as text: its numbers with units and stated errors, and its zones."""

import textwrap
from collections.abc import Iterator

import numpy as np

from contact.inside.field import unit_pressure
from contact.model.controls import Quantity
from contact.model.profiles.noise import EPS
from contact.model.scene import Scene
from contact.model.units import headed, quantity, text_table, with_error
from contact.solution.export import ZONE_COLUMNS, ZONE_UNITS, zone_table
from contact.solution.solution import Solution

Row = tuple[str, str, str]

HEADS = ("quantity", "value", "error at most")


def title(scene: Scene) -> str:
    """One line of text with the names of the scene's parts, such as the profile and the law."""
    parts = [f"{scene.profile.title} profile", f"{scene.interaction.name} interaction"]
    for kind in ("substrate", "law"):
        part = getattr(scene, kind)
        if part != type(scene).__dict__[kind]:
            parts.append(f"{part.name} {kind}")
    return ", ".join(parts)


def total_width(solution: Solution) -> float:
    """Total width of all zones [m]; the period in full contact, and 0 without contact."""
    if len(solution.zones) == 0:
        return (solution.contact_fraction or 0.0) * (solution.scene.period or 0.0)
    return float(solution.zone_widths.sum())


class Errors:
    """Bounds of the errors of a solution's numbers, by the table in docs/errors.md.

    pressure: of the largest pressure [Pa]. load: of a load that is not given [N/m]. length: of
    approach, mean gap, gap and displacement [m]. stiffness: [N/m^2], None where it is infinite.
    """

    def __init__(self, solution: Solution) -> None:
        self.solution = solution
        scene, fields = solution.scene, solution.fields
        zones, law = solution.zones, scene.law
        unit = unit_pressure(fields) + law.tension
        if len(zones) and (intensity := abs(law.intensity(scene.E_star))):
            # Near a free end, the pressure times sqrt(1 - t^2) is K sqrt(2/half width). Here t runs
            # from -1 to 1 over the zone, and K is the intensity.
            unit = max(unit, 2 * intensity / float(np.sqrt(solution.zone_widths.min())))
        self.pressure = solution.error * unit
        self.load = 3 * self.pressure * total_width(solution)
        approach, stiffness = scene.held(Quantity.APPROACH), solution.stiffness
        if approach is not None and stiffness is not None and np.isfinite(stiffness):
            self.load += EPS * abs(approach * stiffness)  # rounding of the given approach

    @property
    def length(self) -> float:
        scene, widths = self.solution.scene, self.solution.zone_widths
        datum, stiffness = scene.interaction.datum, self.solution.stiffness
        if scene.profile.period is not None:
            size = scene.profile.period
        elif datum is not None:
            size = float(np.sum(widths * (1 + np.abs(np.log(widths / datum)))))
        else:
            size = float(np.sum(widths))
        rounding = self.solution.certificate.gap_rounding
        error = 3 * self.pressure * size / scene.E_star + rounding
        # Without a given point of zero displacement (datum), as for a body on a base, an error of
        # the load changes the approach. So this change is added.
        return error if datum or not stiffness else error + self.load / stiffness

    @property
    def stiffness(self) -> float | None:
        solution, stiffness = self.solution, self.solution.stiffness
        if stiffness is None or not np.isfinite(stiffness):
            return None
        return 4 * solution.error * stiffness**2 / solution.scene.E_star * crowding(solution)


def crowding(solution: Solution) -> float:
    """Largest ratio of the width of a zone to that of a gap next to it, at least 1."""
    zones, widths, period = solution.zones, solution.zone_widths, solution.scene.period
    if period is not None and len(zones):
        zones = np.concatenate((zones, zones[:1] + period))
        widths = np.append(widths, widths[0])
    gaps = zones[1:, 0] - zones[:-1, 1]
    if not len(gaps):
        return 1.0
    # A gap that is narrower than the rounding of positions counts as wide as this rounding.
    gaps = np.maximum(gaps, np.spacing(np.abs(zones).max()))
    return max(1.0, float((np.maximum(widths[1:], widths[:-1]) / gaps).max()))


def numbers(solution: Solution) -> list[Row]:
    """Name, value and bound of the error, as text, of each number that the scene defines."""
    modulus = quantity(solution.scene.E_star, "Pa", 10)
    return [("E*", modulus, "given"), *quantities(solution), *_counts(solution)]


def given_or_found_load(solution: Solution) -> float:
    """The given load [N/m]; the load of the solution if the scene does not give a load."""
    given = solution.scene.given_load
    return solution.load if given is None else given


def quantities(solution: Solution, most: int = 10) -> Iterator[Row]:
    """Name, value and bound of the error of the measured quantities, with up to `most` digits."""
    scene, errors, width = solution.scene, Errors(solution), total_width(solution)
    period, ratio = scene.profile.period, abs(scene.law.shear_ratio)
    fraction, load = solution.contact_fraction, given_or_found_load(solution)
    given = {
        "load": scene.given_load is not None,
        "mean pressure": scene.given_load is not None,
        "approach": scene.held(Quantity.APPROACH) is not None,
        "contact fraction": scene.held(Quantity.WIDTH) is not None,
        "width in contact": scene.held(Quantity.WIDTH) is not None
        or scene.held(Quantity.HALF_WIDTH) is not None,
        "tilt": scene.tilt is not None,
        "moment": scene.moment is not None,
    }
    found: list[tuple[str, float | None, str, float | None]] = [
        ("load", load, "N/m", errors.load),
        ("mean pressure", load / period if period else None, "Pa", errors.load / (period or 1.0)),
        ("largest pressure", solution.max_pressure, "Pa", errors.pressure),
        ("approach", solution.approach, "m", errors.length),
        ("contact fraction", fraction, "", 2 * solution.error * (fraction or 0.0)),
        ("width in contact", width, "m", 2 * solution.error * width),
        ("mean gap", solution.mean_gap, "m", errors.length),
        ("stiffness", solution.stiffness, "N/m^2", errors.stiffness),
    ]
    if ratio:
        error = 0.0 if given["load"] else ratio * errors.load
        found.insert(1, ("tangential load", solution.tangential_load, "N/m", error))
    if scene.turning:
        arm = float(np.abs(solution.zones).max(initial=0.0))
        found.append(("tilt", solution.tilt, "rad", None))
        found.append(("moment", solution.moment, "N", errors.load * arm))
    for name, value, unit, bound in found:
        # Surfaces that are apart under a given load have an infinite gap, which is left out.
        if value is not None and (np.isfinite(value) or not is_apart(solution)):
            text, shown = with_error(value, 0.0 if given.get(name) else bound, unit, most)
            yield name, text, "given" if given.get(name) else shown


def _counts(solution: Solution) -> Iterator[Row]:
    """Rows on the zones and other intervals, the branch, the certificate and the stated error."""
    yield "zones", zone_count(solution), ""
    for name, table in (("cohesive intervals", solution.cohesive), ("plateaus", solution.plateaus)):
        if len(table):
            width = quantity(float(np.diff(table, axis=1).sum()), "m", 7)
            yield name, f"{len(table)}, {width} in total", ""
    if solution.branch is not None:
        yield "branch", solution.branch, ""
    yield "certificate", "holds" if solution.certificate.holds else "fails", ""
    yield "stated error", "", f"{solution.error:.2g}"


def zone_count(solution: Solution) -> str:
    """The number of zones, or why there are none, as text."""
    if is_apart(solution):
        return "none: the surfaces are apart"
    return str(len(solution.zones) or "full contact")


def is_apart(solution: Solution) -> bool:
    """Whether the surfaces touch nowhere."""
    return not len(solution.zones) and not solution.contact_fraction


def checks(solution: Solution) -> list[tuple[str, str]]:
    """Name and value of each check of the certificate, as text with units."""
    found = solution.certificate.to_dict().items()
    return [(k.replace("_", " "), _entry(v, _CHECKED.get(k, ""))) for k, v in found if v != ""]


# Unit of each entry of a certificate.
_CHECKED = {
    "smallest_pressure": "Pa",
    "smallest_gap": "m",
    "gap_rounding": "m",
    "level_spread": "m",
    "smallest_overlap": "m",
}


def _entry(value: object, unit: str) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, float):
        return quantity(value, unit) if unit else f"{value:.4g}"
    return "not defined" if value is None else str(value)


def zone_columns(solution: Solution, most: int = 10) -> list[tuple[str, list[str]]]:
    """Columns (header, cells) of the table of zones, numbered from 0 as in `Solution.zones`.
    If there are more than `most` zones, only the widest are shown.
    """
    rows = zone_table(solution)
    widest = np.argsort([-row[2] for row in rows], kind="stable")[:most]
    places = np.sort(widest).tolist()
    if not places:
        return []
    # The numbers are printed with the digits that the stated error allows.
    digits = int(np.clip(1 - np.floor(np.log10(max(solution.error, EPS))), 2, 7))
    known = dict(zip(ZONE_COLUMNS, zip(*(rows[k] for k in places), strict=True), strict=True))
    alike = {"left": "right", "mean_pressure": "max_pressure"}
    alike |= {other: name for name, other in alike.items()}
    columns = [("zone", list(map(str, places)))]
    for name, unit in zip(ZONE_COLUMNS, ZONE_UNITS, strict=True):
        more = 2 if name in ("left", "right") else 0
        beside = known[alike[name]] if name in alike else ()
        columns.append(headed(heading(name), known[name], unit, digits + more, beside))
    return columns


# Names of numbers in tables. Only names that differ from those in Python are listed.
_LABELS = {
    "max_pressure": "largest pressure",
    "total_width": "width in contact",
    "zone_count": "zones",
}


def label(name: str) -> str:
    """The name that tables show for a number."""
    return _LABELS.get(name, name.replace("_", " "))


def heading(name: str) -> str:
    """The name that tables show for a number, in two lines."""
    return "\n".join(label(name).rsplit(" ", 1))


def report(solution: Solution, most: int = 10) -> str:
    """The solution as text, at most 80 columns wide.
    If there are more than `most` zones, only the widest are shown.
    """
    rows = zip(*numbers(solution), strict=True)
    parts = [
        *textwrap.wrap(title(solution.scene), 80),
        "",
        text_table(list(zip(HEADS, rows, strict=True))),
    ]
    if columns := zone_columns(solution, most):
        parts += ["", text_table(columns, words=())]
    if (more := len(solution.zones) - most) > 0:
        parts.append(f"the {most} widest zones; {more} more in zone_table()")
    if not solution.certificate.holds:
        parts += ["", *textwrap.wrap(f"the certificate fails: {solution.certificate.note}", 80)]
    return "\n".join(parts)
