"""The laws of the interface, one a file; importing this package registers them."""

from contact.model.laws.base import Law
from contact.model.laws.dugdale import Dugdale
from contact.model.laws.frictionless import Frictionless
from contact.model.laws.jkr import JKR
from contact.model.laws.plastic import Plastic
from contact.model.laws.sliding import Sliding, dundurs_beta
