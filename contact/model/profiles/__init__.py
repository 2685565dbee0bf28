"""The profile families, one a file; importing this package registers them."""

from contact.model.profiles.base import Profile
from contact.model.profiles.biquadratic import Biquadratic
from contact.model.profiles.combined import Combined
from contact.model.profiles.flat import Flat
from contact.model.profiles.fourier import Fourier
from contact.model.profiles.parabola import Parabola
from contact.model.profiles.polynomial import Polynomial
from contact.model.profiles.power import Power
from contact.model.profiles.sampled import Sampled, read_trace
from contact.model.profiles.self_affine import self_affine
from contact.model.profiles.sinusoid import Sinusoid
from contact.model.profiles.wedge import Wedge
