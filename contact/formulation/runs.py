"""Runs of samples that are alike."""

import numpy as np

from sie import Mask


def runs_of(flags: Mask) -> list[tuple[int, int]]:
    """First and last index of every run of True."""
    change = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)))
    return [(int(s), int(e) - 1) for s, e in zip(change[::2], change[1::2], strict=True)]
