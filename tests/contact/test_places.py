"""Columns and conditions of an interaction of one's own that speak of places: told where these
stand, whatever the solver counts from.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import contact
import sie


@dataclass(frozen=True)
class Hinged(contact.Interaction):
    """A lone body that turns about a hinge at a place x [m], where its pressure has no moment."""

    name = "hinged"
    allows = ("load",)
    hinge: float

    def placed_columns(self, period, centre, scaled):
        return (
            sie.Forcing(
                lambda x: np.full(np.shape(x), -1.0),
                lambda x: scaled(np.array(self.hinge)) - x,
                resolution=sie.Resolution(modes=1),
            ),
        )

    def placed_conditions(self, period, scaled):
        return (sie.moment(0.0, about=float(scaled(np.array(self.hinge)))),)


@pytest.mark.parametrize(("hinge", "tip"), [(0.0, 0.0), (5e-4, 0.0), (0.05, 0.0502), (5.0, 5.0003)])
def test_a_hinge_stands_where_it_is_said_to(hinge, tip):
    """A parabola turned by t has its tip at x = tip + R t: without moment about the hinge that is
    where the zone is centred.
    """
    shape = contact.Polynomial([0.5 * tip**2, -tip, 0.5])
    solution = contact.solve(contact.Scene(shape, 1e9, Hinged(hinge), load=1e3), tol=1e-10)
    middle = solution.zones.mean()
    width = float(solution.zone_widths[0])
    assert abs(middle - hinge) < 1e-8 * width + 4 * np.spacing(abs(hinge))
    assert width == pytest.approx(4 * np.sqrt(1e3 / (np.pi * 1e9)), rel=1e-9)


def test_what_the_engine_refuses_of_a_scene_is_an_error_of_the_scene(monkeypatch):
    def refused(*_, **__):
        raise ValueError("the right side: primitive is not an antiderivative of its value")

    monkeypatch.setattr(sie, "find_ends", refused)
    with pytest.raises(contact.SceneError, match="antiderivative"):
        contact.solve(
            contact.Scene(
                contact.Polynomial((0.0, 0.0, 0.5, 0.1, 1.0)), 1e9, contact.Isolated(), load=1e3
            )
        )
