"""Exact solutions, by the name they are known under: see contact.reference.exact."""

from contact.reference.exact import *  # noqa: F403
