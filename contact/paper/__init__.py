"""The equations of the paper, apart from the solver: I. G. Goryacheva & I. Tsukanov, "Analysis of Elastic Normal Contact of
Surfaces With Regular Microgeometry Based on the Localization Principle", Front. Mech. Eng. 6 (2020) 45,
doi 10.3389/fmech.2020.00045.

    (6)-(17)   principle    any symmetric shape, by quadrature
    (18)-(24)  one_zone     LocalizedWave, AlmostFullWave (Johnson's, which the results name)
    (25)-(27)               LocalizedWedge
    (28)-(30)               LocalizedParabola
    (31)-(39)  two_zones    LocalizedPair (the full artanh), CubicPair (37)-(38)

Plain names are the corrected equations. What the paper prints instead has `Printed` or `printed` before its name. The exact
solutions beside them are those of `contact.exact`.
"""

from contact.paper.one_zone import (
    AlmostFullWave,
    LocalizedParabola,
    LocalizedWave,
    LocalizedWedge,
    PrintedLocalizedWedge,
    PrintedWestergaard,
)
from contact.paper.principle import (
    LocalizedShape,
    PrintedLocalizedShape,
    cauchy_slope,
    neighbour_slope,
    printed_cauchy_slope,
    printed_strip_slope,
    strip_slope,
)
from contact.paper.two_zones import CubicPair, LocalizedPair, PrintedArtanhPair, PrintedCubicPair
from contact.reference.exact.localized import FIRST_ORDER, SELF_CONSISTENT

__all__ = [
    "FIRST_ORDER", "SELF_CONSISTENT", "AlmostFullWave", "CubicPair", "LocalizedPair", "LocalizedParabola",
    "LocalizedShape", "LocalizedWave", "LocalizedWedge", "PrintedArtanhPair", "PrintedCubicPair",
    "PrintedLocalizedShape", "PrintedLocalizedWedge", "PrintedWestergaard", "cauchy_slope", "neighbour_slope",
    "printed_cauchy_slope", "printed_strip_slope", "strip_slope",
]
