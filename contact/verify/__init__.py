"""Is it the solution: fields in, a certificate and a stated error out."""
