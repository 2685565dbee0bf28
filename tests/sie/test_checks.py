"""Checks of a user's functions: wrong ones are refused by name before the equation is solved."""

import numpy as np
import pytest

import sie
from sie.equation.checks import check_functions

TWO = [[-1.0, -0.2], [0.3, 1.0]]
MIRRORED = [[-1.0, -0.2], [0.2, 1.0]]
LEVEL = (sie.Total(1.0), sie.EqualPotential())


def solve(forcing, conditions=LEVEL, ends=TWO, kernel=None, columns=(), symmetric=False):
    zones = sie.Zones.of(ends, sie.SINGULAR, sie.SINGULAR, symmetric=symmetric)
    return sie.solve_fixed(
        sie.Equation(kernel or sie.cauchy(), forcing, conditions, columns), zones
    )


SHAPES = {
    "must return an array of shape": (
        lambda x: 1.0,
        lambda x: x[:-1],
        lambda x: x[:, None],
        lambda x: np.zeros(7),
    ),
    "must return numbers": (lambda x: None, lambda x: np.array(["a"] * len(x))),
    "must return real numbers": (
        lambda x: np.exp(1j * x),
        lambda x: np.zeros(len(x), dtype=complex),
    ),
}


@pytest.mark.parametrize("message", SHAPES)
def test_a_right_side_a_primitive_or_a_column_of_another_shape_or_kind_is_refused_by_name(message):
    for wrong in SHAPES[message]:
        with pytest.raises(ValueError, match=f"the right side: value {message}"):
            solve(sie.Forcing(wrong, lambda x: 0.5 * x * x))
        with pytest.raises(ValueError, match=f"the right side: primitive {message}"):
            solve(sie.Forcing(lambda x: x, wrong))
        with pytest.raises(ValueError, match=f"column 0: value {message}"):
            solve(
                sie.Forcing(np.sin, lambda x: -np.cos(x)),
                (*LEVEL, sie.moment(0.0)),
                columns=(sie.Forcing(wrong, lambda x: x),),
            )


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda x, xi: 1.0, "of shape"),
        (lambda x, xi: np.outer(x, xi), "of shape"),
        (lambda x, xi: x, "of shape"),
        (lambda x, xi: 1j * x * xi, "must return real numbers"),
    ],
)
def test_a_regular_kernel_of_another_shape_or_kind_is_refused_by_name(wrong, message):
    right = sie.Forcing(np.sin, lambda x: -np.cos(x))
    with pytest.raises(ValueError, match=f"the kernel's regular part.*{message}"):
        solve(right, (sie.ZoneTotals(1.0),), kernel=sie.cauchy() + sie.Smooth(wrong))
    with pytest.raises(ValueError, match=f"the kernel's regular potential.*{message}"):
        solve(right, kernel=sie.cauchy() + sie.Smooth(lambda x, xi: x - xi, wrong))


@pytest.mark.parametrize(
    "primitive",
    [np.cos, lambda x: -1.01 * np.cos(x), np.sin, np.zeros_like, lambda x: 1 - np.cos(x) + x],
)
def test_a_primitive_of_another_function_is_refused_by_name(primitive):
    with pytest.raises(
        ValueError, match="the right side: primitive is not an antiderivative of its value"
    ):
        solve(sie.Forcing(np.sin, primitive))
    with pytest.raises(ValueError, match="column 0: primitive is not"):
        solve(
            sie.Forcing(np.sin, lambda x: -np.cos(x)),
            (*LEVEL, sie.moment(0.0)),
            columns=(sie.Forcing(np.sin, primitive),),
        )
    # Without a condition on potentials, the primitive is not checked.
    solve(sie.Forcing(np.sin, primitive), (sie.ZoneTotals(1.0),))


@pytest.mark.parametrize("symmetric", [False, True])
@pytest.mark.parametrize("kappa", [0.0, 0.3j])
@pytest.mark.parametrize("conditions", [LEVEL, (sie.ZoneTotals(1.0),)])
def test_the_functions_of_a_trusted_forcing_are_not_checked(conditions, kappa, symmetric):
    """The check of numbers of arguments, of shapes and of primitives calls the function itself."""
    zones = sie.Zones.of(MIRRORED, sie.SINGULAR, sie.SINGULAR, symmetric=symmetric)

    def called(x):
        raise AssertionError("the function is called by a check")

    forcing = sie.Forcing(called, called).trusted()
    equation = sie.Equation(sie.cauchy(), forcing, conditions, kappa=kappa)
    check_functions(equation, equation.weighted(zones))


@pytest.mark.parametrize("seed", range(40))
def test_a_rounded_primitive_is_accepted(seed):
    """The primitive is rounded to multiples of `unit`. On narrow zones far from the origin, this
    changes its slope between close points, but it is no reason to refuse the primitive.
    """
    rng = np.random.default_rng(seed)
    at, unit = rng.uniform(0.9, 1.1), 10 ** rng.uniform(-10.5, -9)
    zones = at + np.array([[0.0, 2.2e-4], [5e-4, 8e-4]])
    rounded = sie.Forcing(lambda x: -np.ones_like(x), lambda x: unit * np.round(-x / unit))
    conditions = (sie.Total(1.0), sie.EqualPotential())
    equation = sie.Equation(sie.cauchy(), rounded, conditions)
    sie.solve(equation, sie.Zones.of(zones, sie.SINGULAR, sie.SINGULAR), 1e-3)


@pytest.mark.parametrize("potential", [lambda x, xi: np.cos(x - xi), lambda x, xi: -np.sin(x - xi)])
def test_a_regular_potential_of_another_kernel_is_refused_by_name(potential):
    kernel = sie.cauchy() + sie.Smooth(lambda x, xi: np.cos(x - xi), potential)
    with pytest.raises(
        ValueError, match="regular potential is not an antiderivative of its regular part"
    ):
        solve(sie.Forcing(np.sin, lambda x: -np.cos(x)), kernel=kernel)


def test_a_sum_of_kernels_has_a_potential_only_if_all_of_them_have():
    bare, whole = (
        sie.Smooth(lambda x, xi: x + xi),
        sie.Smooth(lambda x, xi: np.cos(x - xi), lambda x, xi: np.sin(x - xi)),
    )
    for kernel in (
        sie.cauchy() + bare + whole,
        sie.cauchy() + whole + bare,
        sie.hilbert(5.0) + bare,
    ):
        assert kernel.regular_potential is None
        with pytest.raises(ValueError, match="potential"):
            solve(sie.Forcing(np.sin, lambda x: -np.cos(x)), kernel=kernel)
    assert (sie.hilbert(5.0) + whole).regular_potential is not None


def test_rough_right_sides_with_their_own_primitives_are_accepted():
    """The right sides have kinks, undeclared jumps, a fast wave or a large constant in the
    primitive. Each is also solved on narrow zones far from the origin.
    """
    for value, primitive in (
        (np.sign, np.abs),
        (lambda x: 1.0 * (x > 0.65), lambda x: np.maximum(x - 0.65, 0.0)),
        (lambda x: np.sin(3e3 * x), lambda x: -np.cos(3e3 * x) / 3e3),
        (lambda x: x, lambda x: 1e6 + 0.5 * x * x),
        (
            lambda x: np.sin(x) + 1e-3 * np.sign(np.sin(500 * x)),
            lambda x: -np.cos(x) + 1e-3 * np.arccos(np.cos(500 * x)) / 500,
        ),
    ):
        solve(sie.Forcing(value, primitive))
        solve(sie.Forcing(value, primitive), ends=1e3 + 1e-5 * np.array(TWO))


# Symmetric sets
# -----------------------------------------------------------------------------------------------------------------
def test_data_without_mirror_symmetry_are_refused_on_symmetric_zones():
    odd, even = sie.Forcing(np.sin, lambda x: -np.cos(x)), sie.Forcing(np.cos, np.sin)
    solve(odd, ends=MIRRORED, symmetric=True)
    with pytest.raises(ValueError, match="symmetric=True.*right side: value is not odd"):
        solve(even, ends=MIRRORED, symmetric=True)
    with pytest.raises(ValueError, match="symmetric=True.*column 0: value is not odd"):
        solve(odd, (*LEVEL, sie.moment(0.0)), MIRRORED, columns=(even,), symmetric=True)
    with pytest.raises(ValueError, match="symmetric=True.*regular part is not odd"):
        solve(
            odd,
            (sie.ZoneTotals(1.0),),
            MIRRORED,
            sie.cauchy() + sie.Smooth(lambda x, xi: np.cos(x + 2 * xi)),
            symmetric=True,
        )


def test_an_asymmetry_between_the_check_points_enters_the_stated_error():
    bump = sie.Forcing(lambda x: np.sin(x) + 0.01 * np.exp(-(((x + 0.42) / 0.03) ** 2)))
    state = solve(bump, (sie.ZoneTotals(1.0),), MIRRORED, symmetric=True)
    assert state.density_error * state.size > 1e-3
    assert solve(bump, (sie.ZoneTotals(1.0),), MIRRORED).density_error < 1e-12


# Kernels that declare a reach, and many zones
# ----------------------------------------------------------------------------------
@pytest.mark.parametrize("reach", [0.0, 0.3, 2.0, 100.0, np.inf])
@pytest.mark.parametrize("ends", [[[-1.0, 1.0]], TWO], ids=len)
def test_the_declared_reach_of_a_regular_part_does_not_change_the_solution(reach, ends):
    kernel = sie.Kernel(regular=lambda x, xi: np.cos(2 * (x - xi)), reach=reach)
    state = solve(sie.Forcing(np.sin), (sie.ZoneTotals(1.0),), ends, kernel)
    other = solve(
        sie.Forcing(np.sin), (sie.ZoneTotals(1.0),), ends, sie.cauchy() + sie.Smooth(kernel.regular)
    )
    assert state.system.layout.m.min() >= 10
    t = np.linspace(-0.9, 0.9, 9)
    for i in range(len(ends)):
        assert state.density.at_t(i, t) == pytest.approx(other.density.at_t(i, t), abs=1e-13)
    # Independent check: the regular part's transform by Gauss's rule (`rest`), plus the transform
    # with 1 / (x - xi) alone (`poles`), is the right side.
    angle = (np.arange(60) + 0.5) * np.pi / 60
    middle, half = state.density.zones.middle[:, None], state.density.zones.half[:, None]
    xi = middle + half * np.cos(angle)
    weights = (
        state.density.at_t(np.arange(len(ends))[:, None], np.cos(angle)) * np.sin(angle) * half / 60
    )
    x = middle[0, 0] + half[0, 0] * t
    rest = np.array([np.sum(weights * np.cos(2 * (one - xi))) for one in x])
    poles = sie.Density(
        state.density.zones,
        sie.cauchy(),
        state.density.coefficients,
        state.density.jumps,
        np.zeros(0),
    )
    assert poles.transform(x) + rest == pytest.approx(np.sin(x), abs=1e-12)
    assert state.density_error < 1e-12


def test_with_a_user_s_kernel_only_zones_that_need_more_modes_get_more():
    """Only the two zones beside the narrow gap, 19 and 20, need many modes. Round-off from the
    neighbours' fields in lightly loaded zones must not count as truncation.
    """
    place = np.arange(40)
    light, narrow = place % 7 == 3, place % 9 == 5
    table = np.column_stack((place, place + np.where(narrow, 0.01, 0.6)))
    table[20, 0] = table[19, 1] + 0.01
    kernel = sie.cauchy() + sie.Smooth(lambda x, xi: 0.3 * np.sin(0.1 * (x - xi)))
    totals = tuple(np.where(light, 1e-4, 1.0))
    state = solve(sie.Forcing(lambda x: 0.01 * np.sin(x)), (sie.ZoneTotals(totals),), table, kernel)
    m = state.system.layout.m
    assert m[[19, 20]].min() > 60
    assert np.delete(m, [19, 20]).max() <= 32
    assert state.sizes.solves <= 3
    assert state.density_error < 1e-11


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"poles": (1.0, 0.0)}, "first of them 0"),
        ({"poles": (0.0, 1.0, 1.0)}, "different"),
        ({"poles": ()}, "poles"),
        ({"period": -1.0}, "period"),
        ({"datum": 0.0}, "datum"),
        ({"regular_potential": lambda x, xi: x}, "regular_potential but not regular"),
    ],
)
def test_invalid_kernels_are_refused_by_name(options, message):
    with pytest.raises(ValueError, match=message):
        sie.Kernel(**options)


def test_a_primitive_that_rises_by_less_than_its_round_off_is_accepted():
    # On zones about 1e-10 wide, the primitive 1 + x^2 rises by less than its round-off of 1e-16.
    # So its rise cannot be checked, and it must not be refused.
    forcing = sie.Forcing(lambda x: 2 * x, lambda x: 1 + x**2)
    zones = sie.Zones.of(np.array([[-1e-10, 1e-10], [2e-10, 3e-10]]))
    check_functions(sie.Equation(sie.cauchy(), forcing, (sie.EqualPotential(),)), zones)
