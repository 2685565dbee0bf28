"""Exact solutions in closed form, one file per family; solvers are judged by them.

All of them build on contact.reference.exact.base. Nothing here imports the solver.

Conventions: (1/pi) PV int p(xi) K(x - xi) dxi = (E*/2) f'(x), K = 1/(x - xi), or (pi/L) cot(pi (x -
xi)/L) with a period L; p >= 0 in compression, f grows away from contact, the load is per unit
thickness. Equation numbers are those of Goryacheva & Tsukanov (2020), doi 10.3389/fmech.2020.00045.

| profile | isolated | periodic |
|---|---|---|
| parabola | `HertzLine`, `TiltedParabola` | `PeriodicParabola` |
| wedge | `IsolatedWedge`, `TiltedWedge` | `PeriodicWedge` |
| wave | `IsolatedSinusoid` | `Westergaard`, `FullContactSinusoid`, both by `sinusoid` |
| power law | `IsolatedPower` | `PeriodicPower` |
| flat punch | `IsolatedPunch`, `TiltedPunch` | `PeriodicPunch` |
| two tips | `IsolatedBiquadratic` | `PeriodicBiquadratic` |
| any two zones under an even pressure | `EvenPair` | `EvenPair` |
| one zone, localized | | `LocalizedZone`, `localized_at_load` |
| one zone, JKR | `JKRZone`, `JKRCylinder` | `JKRZone`, `JKRWave` |
| one zone, Maugis-Dugdale | `DugdaleZone`, `DugdaleCylinder` | `MetDugdaleZone`, `DugdaleWave` |
"""

from contact.reference.exact.adhesion import AdhesiveZone
from contact.reference.exact.base import SymmetricZone
from contact.reference.exact.biquadratic import IsolatedBiquadratic
from contact.reference.exact.dugdale import (
    DugdaleCylinder,
    DugdaleWave,
    DugdaleZone,
    MetDugdaleZone,
)
from contact.reference.exact.flat import IsolatedPunch, PeriodicPunch
from contact.reference.exact.jkr import JKRCylinder, JKRWave, JKRZone
from contact.reference.exact.localized import (
    LocalizedZone,
    correction_load,
    correction_pressure,
    localized_at_load,
)
from contact.reference.exact.pair import EvenPair, PeriodicBiquadratic
from contact.reference.exact.parabola import HertzLine, PeriodicParabola
from contact.reference.exact.power import IsolatedPower, PeriodicPower
from contact.reference.exact.sinusoid import (
    FullContactSinusoid,
    IsolatedSinusoid,
    Westergaard,
    sinusoid,
)
from contact.reference.exact.tilted import TiltedParabola, TiltedPunch, TiltedWedge, TiltedZone
from contact.reference.exact.wedge import IsolatedWedge, PeriodicWedge

__all__ = [
    "AdhesiveZone",
    "DugdaleCylinder",
    "DugdaleWave",
    "DugdaleZone",
    "EvenPair",
    "FullContactSinusoid",
    "HertzLine",
    "IsolatedBiquadratic",
    "IsolatedPower",
    "IsolatedPunch",
    "IsolatedSinusoid",
    "IsolatedWedge",
    "JKRCylinder",
    "JKRWave",
    "JKRZone",
    "LocalizedZone",
    "MetDugdaleZone",
    "PeriodicBiquadratic",
    "PeriodicParabola",
    "PeriodicPower",
    "PeriodicPunch",
    "PeriodicWedge",
    "SymmetricZone",
    "TiltedParabola",
    "TiltedPunch",
    "TiltedWedge",
    "TiltedZone",
    "Westergaard",
    "correction_load",
    "correction_pressure",
    "localized_at_load",
    "sinusoid",
]
