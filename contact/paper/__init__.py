"""The examples of the paper in closed form, without the solver.

I. G. Goryacheva & I. Tsukanov, "Analysis of Elastic Normal Contact of Surfaces With Regular
Microgeometry Based on the Localization Principle", Front. Mech. Eng. 6 (2020) 45, doi
10.3389/fmech.2020.00045.

    (18)-(24)  one_zone     localized_wave
    (25)-(27)               localized_wedge
    (28)-(30)               localized_parabola
    (31)-(39)  two_zones    LocalizedPair (the full artanh), CubicPair (37)-(38)

The equations are the corrected ones. `PrintedCubicPair` reproduces figure 13 as printed. The exact
solutions for comparison are in `contact.exact`.
"""

from contact.paper.one_zone import OneZone, localized_parabola, localized_wave, localized_wedge
from contact.paper.two_zones import CubicPair, LocalizedPair, PrintedCubicPair
from contact.reference.exact.localized import FIRST_ORDER, SELF_CONSISTENT

__all__ = [
    "FIRST_ORDER",
    "SELF_CONSISTENT",
    "CubicPair",
    "LocalizedPair",
    "OneZone",
    "PrintedCubicPair",
    "localized_parabola",
    "localized_wave",
    "localized_wedge",
]
