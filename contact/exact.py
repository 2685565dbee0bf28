"""Exact solutions, named as in the literature: see contact.reference.exact."""

from contact.reference.exact import *  # noqa: F403
