"""Strategies, one in each file: a context comes in, a contact or a `Failure` goes out."""
