"""The elastic bodies, one a file; importing this package registers them."""

from contact.model.substrates.base import Substrate
from contact.model.substrates.half_plane import HalfPlane
from contact.model.substrates.layer import Layer
