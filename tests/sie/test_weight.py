"""Exponents of a density at the ends of zones: scales that follow from them, and parts of the
code that are valid for 1/2 only.
"""

from dataclasses import replace

import numpy as np
import pytest

import sie
from sie.basis.interval import intensities, sides
from sie.basis.weight import HALF, Weight
from sie.ends.motions import Moved
from sie.ends.newton import find_ends
from sie.fast.system import unfit

OTHER = Weight(np.array([0.7]))
NEAR = 1e-9  # distance from an end, over the half width


def on(table, **kinds):
    """Zones with the exponents of kappa = 0.7."""
    zones = sie.Zones.of(table, **kinds)
    return replace(zones, weight=Weight(np.full(len(zones), 0.7)))


@pytest.mark.parametrize("kappa", [-3.0, 0.0, 0.4])
@pytest.mark.parametrize("w", [0.25, 3.0])
def test_the_scales_are_the_limits_of_the_weight_at_both_ends(kappa, w):
    weight, alpha = Weight(np.array([kappa])), np.arctan2(1.0, kappa) / np.pi
    d, sine = NEAR * w, np.sin(np.pi * alpha)
    left, right = weight.exponent.ravel()
    assert (left, right) == pytest.approx((alpha, 1 - alpha), abs=1e-15)
    scales = weight.edge_scale(w).ravel()
    singular = sine * np.array(
        [NEAR**-alpha * 2 ** (alpha - 1) * d**left, NEAR ** (alpha - 1) * 2**-alpha * d**right]
    )
    assert scales == pytest.approx(singular, rel=1e-8)
    bounded = sine * np.array([2**alpha * NEAR ** (1 - alpha), 2 ** (1 - alpha) * NEAR**alpha])
    slopes = weight.slope_scale(w).ravel() * np.array([d ** (1 - left), d ** (1 - right)])
    assert slopes == pytest.approx(bounded, rel=1e-8)


@pytest.mark.parametrize("weight", [HALF, Weight(np.array([-3.0])), Weight(np.array([0.4]))])
def test_the_step_of_an_end_removes_its_intensity_to_first_order(weight):
    """If an end moves by s, the density A d^(1-p) at the distance d becomes A (d + s)^(1-p), to
    first order A d^(1-p) + (1 - p) A s d^(-p). So its intensity is K = (1 - p) A s.
    """
    s, d = 1e-7, 1e-2
    p = np.asarray(weight.exponent)
    found = ((d + s) ** (1 - p) - d ** (1 - p)) * d**p
    assert weight.end_step(found, 1.0) == pytest.approx(np.full(p.shape, s), rel=1e-4)
    assert weight.secant_slope(-found, s) == pytest.approx(np.ones(p.shape), rel=1e-4)


def test_the_scales_for_one_half_agree_with_the_functions_of_sie_basis_interval():
    w = np.array([0.3, 2.0])
    assert intensities(np.ones(2), np.zeros(2), w)[1] == pytest.approx(
        HALF.edge_scale(w), rel=1e-15
    )
    assert HALF.slope_scale(w) * np.sqrt(NEAR * w) == pytest.approx(
        np.sin(2 * np.arcsin(np.sqrt(0.5 * NEAR))), rel=1e-8
    )
    assert sides(np.array([0.0]))[0] == 2.0


class TestPartsThatAreValidForOneHalfOnly:
    EQUATION = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(1.0),))

    def test_the_rows_refuse_another_exponent(self):
        with pytest.raises(
            ValueError, match="the rows of the equation: implemented for kappa = 0 only"
        ):
            sie.solve(self.EQUATION, on([[-1.0, 1.0]]))
        with pytest.raises(ValueError, match="the rows of the equation"):
            find_ends(self.EQUATION, on([[-1.0, 1.0]]))

    def test_jumps_slits_and_fast_sums_refuse_another_exponent(self):
        kink = sie.Forcing(np.sign, jumps=sie.Jumps([0.0], 2.0))
        with pytest.raises(ValueError, match="jumps in closed form"):
            kink.jumps_within(on([[-1.0, 1.0]]), sie.cauchy())
        charge = sie.Equation(
            sie.cauchy(),
            sie.Forcing(np.zeros_like, np.zeros_like),
            (sie.Total(1.0), sie.EqualPotential()),
        )
        near = on([[-1.0, -0.001], [0.001, 1.0]])
        with pytest.raises(ValueError, match="narrow gaps as slits"):
            sie.solve_zones(charge, near)
        with pytest.raises(ValueError, match="fast sums"):
            unfit(charge, near)

    def test_motions_of_ends_refuse_another_exponent(self):
        state = sie.solve_fixed(self.EQUATION, sie.Zones.of([[-1.0, 1.0]]))
        other = replace(state, density=replace(state.density, zones=on([[-1.0, 1.0]])))
        with pytest.raises(ValueError, match="motions of ends"):
            Moved.of(other, np.ones((2, 1)))
