"""The interaction models, one a file; importing this package registers them."""

from contact.model.interactions.base import Interaction
from contact.model.interactions.isolated import Isolated
from contact.model.interactions.localized import Localized
from contact.model.interactions.periodic import Periodic
