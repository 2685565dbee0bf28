"""The profile families, one a file; importing this package registers them."""

from contact.profiles.base import Profile
from contact.profiles.biquadratic import Biquadratic
from contact.profiles.flat import Flat
from contact.profiles.fourier import Fourier
from contact.profiles.parabola import Parabola
from contact.profiles.polynomial import Polynomial
from contact.profiles.sampled import Sampled
from contact.profiles.sinusoid import Sinusoid
from contact.profiles.wedge import Wedge

__all__ = [
    "Biquadratic",
    "Flat",
    "Fourier",
    "Parabola",
    "Polynomial",
    "Profile",
    "Sampled",
    "Sinusoid",
    "Wedge",
]
