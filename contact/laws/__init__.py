"""The laws of the interface, one a file; importing this package registers them."""

from contact.laws.base import Law
from contact.laws.frictionless import Frictionless

__all__ = ["Frictionless", "Law"]
