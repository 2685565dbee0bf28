"""Columns and conditions of a user's interaction that depend on a position x [m] in the profile.

The solver may count positions from another origin. The position in the model stays the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import contact
import sie


@dataclass(frozen=True)
class Hinged(contact.Interaction):
    """An isolated body with a hinge at x [m], about which the pressure has no moment."""

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
def test_the_zone_of_a_hinged_body_is_centred_on_the_hinge(hinge, tip):
    """The zone is centred on the hinge, because the pressure has no moment about the hinge.

    The parabola has the radius R = 1. Turned by the angle t, it is the same parabola with its
    tip at x = tip + R t. So the body turns until this tip is at the hinge.
    """
    shape = contact.Polynomial([0.5 * tip**2, -tip, 0.5])
    solution = contact.solve(contact.Scene(shape, 1e9, Hinged(hinge), load=1e3), tol=1e-10)
    middle = solution.zones.mean()
    width = float(solution.zone_widths[0])
    assert abs(middle - hinge) < 1e-8 * width + 4 * np.spacing(abs(hinge))
    assert width == pytest.approx(4 * np.sqrt(1e3 / (np.pi * 1e9)), rel=1e-9)


def test_a_value_error_of_the_engine_becomes_a_scene_error(monkeypatch):
    def refused(*_, **__):
        raise ValueError("the right side: primitive is not an antiderivative of its value")

    monkeypatch.setattr(sie, "find_ends", refused)
    with pytest.raises(contact.SceneError, match="antiderivative"):
        contact.solve(
            contact.Scene(
                contact.Polynomial((0.0, 0.0, 0.5, 0.1, 1.0)), 1e9, contact.Isolated(), load=1e3
            )
        )
