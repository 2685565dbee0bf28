"""Exact problems for zones of one's choice: see contact.reference.inverse."""

from contact.reference.inverse import *  # noqa: F403
