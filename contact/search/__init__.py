"""Which zones: a scaled problem in, zones whose signs are right out."""
