"""The elastic bodies, one a file; importing this package registers them."""

from contact.substrates.base import Substrate
from contact.substrates.half_plane import HalfPlane
from contact.substrates.layer import Layer

__all__ = ["HalfPlane", "Layer", "Substrate"]
