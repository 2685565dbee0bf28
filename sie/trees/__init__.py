"""Sums over very many intervals in linear time: a tree and series of far ones, GMRES, and an
approximate inverse.
"""
