"""Exact problems with zones of one's choice, by the name they are known under: see
contact.reference.inverse.
"""

from contact.reference.inverse import *  # noqa: F403
