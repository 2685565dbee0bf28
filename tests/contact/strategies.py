"""Hypothesis strategies that draw exact contact problems.

Every problem is a function of a few bounded numbers, so that hypothesis can simplify a failure.
"""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from contact.reference.inverse import DesignedContact, design, random_adhesive_problem

PERIODS = (1.0, 2.0 * np.pi, 1e-4)


@st.composite
def designed_contacts(draw, min_zones=1, max_zones=12, periodic=None, nearest=0.03):
    """An exact problem of `min_zones` to `max_zones` unlike zones, off the origin.

    It is isolated or periodic. No zone is narrower than `nearest` times the widest zone, and no
    gap is narrower than `nearest` times the widest gap.
    """
    count = draw(st.integers(min_zones, max_zones))
    length = st.floats(nearest, 1.0, allow_nan=False)
    widths = np.array(draw(st.lists(length, min_size=count, max_size=count)))
    gaps = np.array(draw(st.lists(length, min_size=count, max_size=count)))
    share = draw(st.floats(0.1, 0.9))
    shift = draw(st.floats(-0.5, 0.5))
    cell = draw(st.sampled_from(PERIODS))
    repeats = draw(st.booleans()) if periodic is None else periodic
    E_star = 10.0 ** draw(st.floats(-1.0, 11.0))
    strain = 10.0 ** draw(st.floats(-3.0, -1.0))
    steps = np.stack(
        [gaps * (1.0 - share) / np.sum(gaps), widths * share / np.sum(widths)], axis=1
    ).ravel()
    unit = np.cumsum(steps).reshape(count, 2) + shift
    if repeats:
        unit = unit - np.floor(unit[:, :1] + 0.5)
        unit = unit[np.argsort(unit[:, 0])]
    problem: DesignedContact = design(
        cell * unit, E_star, strain * E_star * cell, cell if repeats else None
    )
    return problem


@st.composite
def adhesive_designs(draw, periodic=None):
    """One to six unlike zones from a random seed; adhesion is weak or stronger than the load."""
    seed, count = draw(st.integers(0, 10**6)), draw(st.integers(1, 6))
    period = (
        draw(st.sampled_from((1.0, 1e-4)))
        if (draw(st.booleans()) if periodic is None else periodic)
        else None
    )
    pull = 10.0 ** draw(st.floats(-3.0, 0.5))
    E_star = 10.0 ** draw(st.floats(-1.0, 11.0))
    return random_adhesive_problem(
        np.random.default_rng(seed), count, period, pull=pull, E_star=E_star
    )
