"""The answer: coefficients on intervals in, values, transforms and potentials anywhere out."""
