"""Zones and a held control in, equilibria out: ends that grow or shrink to rest, curves of
equilibria with their turning points.
"""
