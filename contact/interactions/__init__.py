"""The interaction models, one a file; importing this package registers them."""

from contact.interactions.base import Interaction
from contact.interactions.isolated import Isolated
from contact.interactions.localized import Localized
from contact.interactions.periodic import Periodic

__all__ = ["Interaction", "Isolated", "Localized", "Periodic"]
