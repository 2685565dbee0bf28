"""A user's own part of a scene in, what is wrong with it out."""
