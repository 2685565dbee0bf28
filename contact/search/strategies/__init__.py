"""From the context of a solve to a contact, or to the reason why a strategy failed; one a file."""
