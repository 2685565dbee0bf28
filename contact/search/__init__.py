"""Which zones: a scene in, zones whose signs are right out. `topology`, `grid` and `ways`, in that
order, serve `find` and `refine`.
"""
