"""A solution comes in; derivatives of its numbers by all data of its scene go out."""
