"""An equation and a first guess in, intervals whose ends meet their conditions out: Newton on the
ends.
"""
