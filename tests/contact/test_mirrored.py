"""Traces and their mirror images have one answer, within what both state: all rounding, all grids
and all sides are others.
"""

import pytest

from contact.studies.mirrored import told
from tests.tiers import quick


@pytest.mark.filterwarnings("ignore::contact.ModelWarning")
@pytest.mark.parametrize("seed", quick(range(24), range(6)))
def test_a_trace_and_its_mirror_image_agree(seed):
    assert not told(seed, 120, 1e-8)[1].startswith("apart")
