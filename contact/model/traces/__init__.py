"""An instrument's text file in, points that a profile may go through out."""
