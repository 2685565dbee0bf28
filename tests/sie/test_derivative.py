"""Derivatives of solutions by parameters, against closed forms and finite differences."""

import numpy as np
import pytest

import sie
from sie.results.derivative import Change, Linearized, without_slits

SINGULAR = (sie.SINGULAR, sie.SINGULAR)
PLANE = np.array([0.3 + 0.2j, -1.7 + 0.05j, 3.0 + 0.5j, -2.2 - 0.7j])
STEP = 2.5e-4


@pytest.mark.parametrize("a", [1e-3, 1.0, 40.0])
def test_the_intensity_of_griffith_s_crack_grows_as_the_root_of_its_length(a):
    crack = sie.Equation(sie.cauchy(), lambda x: -np.ones_like(x), sie.ZoneTotals(0.0))
    found = sie.solve(crack, sie.Zones.of([[-a, a]], *SINGULAR))
    longer = found.derivative(dends=[[-1.0, 1.0]])
    right = found.density.intensities[1][0]
    assert abs(abs(right) / np.sqrt(a / 2) - 1) < 1e-12
    assert np.abs(np.abs(longer.intensities) * np.sqrt(8 * a) - 1).max() < 1e-12
    # The derivatives by the place of each end alone add up to the derivative by the half length.
    one = found.derivative(dends=[[0.0, 1.0]])
    other = found.derivative(dends=[[-1.0, 0.0]])
    assert np.abs(one.intensities + other.intensities - longer.intensities).max() < 1e-13 / np.sqrt(
        a
    )
    # The density is phi = x / sqrt(a^2 - x^2).
    t = np.array([-0.9, 0.2, 0.7])
    exact = -t / (a * (1 - t**2) ** 1.5)
    assert np.abs(longer.density(a * t) / exact - 1).max() < 1e-11
    assert np.abs(longer.density.totals).max() < 1e-13


def test_the_field_of_a_longer_crack_is_exact_in_both_half_planes():
    crack = sie.Equation(sie.cauchy(), np.ones_like, sie.ZoneTotals(0.0))
    density = (
        sie.solve(crack, sie.Zones.of([[-1.0, 1.0]], *SINGULAR))
        .derivative(dends=[[-1.0, 1.0]])
        .density
    )
    z = np.array([0.2 + 0.3j, 0.2 - 0.3j, -1.5 + 1e-9j, 2.0 + 0.0j])
    root = np.sqrt(z - 1) * np.sqrt(z + 1)
    assert np.abs(density.transform(z) + z / root**3).max() < 1e-11  # F = 1 - z / root
    slope = -1 / root**3 + 3 * z**2 / root**5
    assert np.abs(density.transform_slope(z) / slope - 1).max() < 1e-10
    assert np.abs(density.potential(z) - 1 / root).max() < 1e-11
    x = np.array([-3.0, 1.2, 0.5])
    outside = -np.abs(x[:2]) / (x[:2] ** 2 - 1) ** 1.5
    assert np.abs(density.transform(x)[:2] - outside).max() < 1e-11
    assert density.transform(x)[2] == 0.0 and abs(density.potential(0.5)) < 1e-13


def test_a_parabolic_contact_follows_its_load_and_its_profile():
    """Hertz: for g = g1 x the load is P = pi a^2 g1 / 2, and the pressure g1 sqrt(a^2 - x^2)."""
    hertz = sie.Equation(sie.cauchy(), lambda x: x, sie.Total(np.pi / 2))
    found = sie.solve(hertz, sie.Zones.of([[-0.8, 1.3]]))
    by_load = found.derivative(values=[1.0])
    x = np.array([-0.9, 0.0, 0.6])
    assert np.abs(by_load.ends - [[-1 / np.pi, 1 / np.pi]]).max() < 1e-10
    assert np.abs(by_load.density(x) * np.pi * np.sqrt(1 - x * x) - 1).max() < 1e-10
    assert not by_load.intensities.any()
    steeper = found.derivative(lambda x: x)
    assert np.abs(steeper.ends - [[0.5, -0.5]]).max() < 1e-10
    tilted = found.derivative(np.ones_like)  # a tilt moves the zone by -1
    assert np.abs(tilted.ends + 1.0).max() < 1e-10


def test_a_wave_follows_its_load():
    """The half width a obeys sin^2(pi a / L) = load / (amplitude L) (Westergaard 1939)."""
    wave = sie.Equation(sie.hilbert(1.0), lambda x: np.sin(2 * np.pi * x), sie.Total(0.3))
    found = sie.solve(wave, sie.Zones.of([[-0.15, 0.2]]))
    a = np.arcsin(np.sqrt(0.3)) / np.pi
    by_load = found.derivative(values=1.0)
    assert np.abs(by_load.ends[0] * [-1, 1] * np.pi * np.sin(2 * np.pi * a) - 1).max() < 1e-9
    assert abs(by_load.density.total - 1.0) < 1e-12


def test_the_capacity_of_an_interval_moves_with_its_end():
    """The potential V of a unit charge obeys pi V = log(length / 4), so dV/db = 1 / (pi length)."""
    still = sie.Forcing(np.zeros_like, np.zeros_like)
    plate = sie.Equation(sie.cauchy(), still, sie.Total(1.0))
    found = sie.solve(plate, sie.Zones.of([[0.0, 3.0]], *SINGULAR))
    density = found.derivative(dends=[[0.0, 1.0]]).density
    assert np.abs(density.potential(np.array([0.5, 2.9])) * 3 * np.pi - 1).max() < 1e-12


def free(s):
    g = sie.Forcing(
        lambda x: x * (x * x - 1) + s * np.cos(x), lambda x: x**4 / 4 - x * x / 2 + s * np.sin(x)
    )
    equation = sie.Equation(sie.cauchy(), g, (sie.Total(0.3 + s), sie.EqualPotential()))
    return equation, sie.Zones.of([[-1.3, -0.6], [0.6, 1.3]]), {}


def free_periodic(s):
    g = sie.Forcing(
        lambda x: np.sin(2 * x) + 0.2 * np.sin(x) + s * np.cos(x),
        lambda x: -np.cos(2 * x) / 2 - 0.2 * np.cos(x) + s * np.sin(x),
    )
    kernel = sie.hilbert(2 * np.pi)
    equation = sie.Equation(kernel, g, (sie.Total(1.3 + s), sie.EqualPotential()))
    return equation, sie.Zones.of([[-0.6, 0.6], [2.7, 3.6]]), {}


def cracks(s, kernel=sie.hilbert(3.5)):  # noqa: B008
    equation = sie.Equation(kernel, lambda x: 1 + 0.3 * np.sin(x) + s * x * x, sie.ZoneTotals(0.0))
    return equation, sie.Zones.of([[-1 + s / 2, 0.6 + s], [0.9 - s / 5, 2.0]], *SINGULAR), {}


def plates(s):
    g = sie.Forcing(lambda x: 1 + 0.3 * x, lambda x: x + 0.15 * x * x)
    equation = sie.Equation(sie.cauchy(), g, sie.Level(0.3 + s))
    return equation, sie.Zones.of([[-1 + s / 2, 0.6 + s], [0.9 - s / 5, 2.0]], *SINGULAR), {}


def aerofoils(s):
    equation = sie.Equation(sie.cauchy(), np.cos)
    zones = [[-1 + s / 2, 0.6 + s], [0.9 - s / 5, 2.0 + s]]
    return equation, sie.Zones.of(zones, sie.SINGULAR, sie.BOUNDED), {}


def both_bounded(s):
    equation = sie.Equation(sie.cauchy(), np.exp, (), np.ones_like)
    return equation, sie.Zones.of([[-1 + s / 2, 0.6 + s]], sie.BOUNDED, sie.BOUNDED), {}


def punch(s):
    equation = sie.Equation(sie.cauchy(), lambda x: x + 0.2, sie.Total(2.0 + s))
    return equation, sie.Zones.of([[-0.8 + s, 0.6]], sie.SINGULAR, sie.FREE), {}


def adhering(s):
    g = sie.Forcing(
        lambda x: x * (x * x - 1) + s * np.cos(x), lambda x: x**4 / 4 - x * x / 2 + s * np.sin(x)
    )
    equation = sie.Equation(sie.cauchy(), g, (sie.Total(0.4 + s), sie.EqualPotential()))
    left, right = sie.free_with_intensity(-0.02 + s / 10), sie.free_with_intensity(-0.03)
    return (
        equation,
        sie.Zones.of([[-1.35, -0.45], [0.45, 1.35]], [left, sie.FREE], [sie.FREE, right]),
        {},
    )


def bell(x, xi):
    return np.exp(-((x - xi) ** 2) / 4) * (x - xi)


def other_kernel(s):
    kernel = sie.cauchy() + (0.3 + s) * sie.Smooth(bell)
    equation = sie.Equation(kernel, lambda x: x + 0.1, sie.Total(1.0))
    return equation, sie.Zones.of([[-1 + s, 1.1]], sie.SINGULAR, sie.FREE), {}


def of_width(s):
    equation = sie.Equation(
        sie.cauchy(),
        lambda x: x + 0.1 * x**3 + s * np.exp(x),
        sie.Total(None),
        end_conditions=sie.TotalWidth(2.0 + s),
    )
    return equation, sie.Zones.of([[-1.0, 1.1]]), {"value": 1.0}


def weighted(s):
    condition = sie.Weighted(lambda x: np.cos(5 * x), 0.4 + s)
    equation = sie.Equation(sie.cauchy(), lambda x: x + 0.1 * x**3, condition)
    return equation, sie.Zones.of([[-1 + s, 1.1]], *SINGULAR), {}


def turned(s):
    conditions = sie.Total(1.0 + s), sie.moment(0.2)
    equation = sie.Equation(sie.cauchy(), np.exp, conditions, np.ones_like)
    return equation, sie.Zones.of([[-1 + s, 1.1]], *SINGULAR), {}


def mirrored(s):
    equation = sie.Equation(sie.cauchy(), lambda x: x + s * x**3, sie.ZoneTotals(0.0))
    ends = [[-2.0, -1.0 - s], [-0.5, 0.5], [1.0 + s, 2.0]]
    return equation, sie.Zones.of(ends, *SINGULAR, symmetric=True), {}


def kinked(s):
    height = 0.3 + s
    g = sie.Forcing(lambda x: x + height * np.sign(x - 0.1), jumps=sie.Jumps([0.1], [2 * height]))
    return sie.Equation(sie.cauchy(), g, sie.Total(1.0)), sie.Zones.of([[-1.0, 1.0]]), {}


KINK = sie.Forcing(lambda x: np.sign(x - 0.1), jumps=sie.Jumps([0.1], [2.0]))
TWO_ENDS = [[0.5, 1.0], [-0.2, 0.0]]
PROBLEMS = [
    (free, {"dg": sie.Forcing(np.cos, np.sin), "values": [1.0, 0.0]}, [-1.0, 0.9, 1.1]),
    (free_periodic, {"dg": sie.Forcing(np.cos, np.sin), "values": [1.0, 0.0]}, [-0.3, 0.1, 3.0]),
    (cracks, {"dg": lambda x: x * x, "dends": TWO_ENDS}, [-0.5, 0.1, 1.4]),
    (plates, {"values": [1.0], "dends": TWO_ENDS}, [-0.5, 0.1, 1.4]),
    (aerofoils, {"dends": [[0.5, 1.0], [-0.2, 1.0]]}, [-0.5, 0.1, 1.4]),
    (both_bounded, {"dends": [[0.5, 1.0]]}, [-0.5, 0.1]),
    (punch, {"values": 1.0, "dends": [[1.0, 0.0]]}, [-0.5, 0.1]),
    (
        adhering,
        {
            "dg": sie.Forcing(np.cos, np.sin),
            "values": [1.0, 0.0],
            "dintensities": [[0.1, 0.0], [0.0, 0.0]],
        },
        [-1.0, 0.9, 1.1],
    ),
    (other_kernel, {"dkernel": bell, "dends": [[1.0, 0.0]]}, [-0.5, 0.1]),
    (of_width, {"dg": np.exp, "values": [0.0, 1.0]}, [-0.5, 0.1]),
    (weighted, {"values": [1.0], "dends": [[1.0, 0.0]]}, [-0.5, 0.1]),
    (turned, {"values": [1.0, 0.0], "dends": [[1.0, 0.0]]}, [-0.5, 0.1]),
    (mirrored, {"dg": lambda x: x**3, "dends": [[0, -1.0], [0, 0], [1.0, 0]]}, [-1.5, 0.2, 1.7]),
    (kinked, {"dg": KINK}, [-0.5, 0.3]),
]


@pytest.mark.parametrize(
    ("problem", "change", "x"), PROBLEMS, ids=lambda p: getattr(p, "__name__", "")
)
def test_derivatives_are_the_limits_of_differences(problem, change, x):
    """Each derivative is compared with a fourth-order difference of four solutions, whose error
    is about 1e-9.
    """

    def solved(s):
        equation, zones, more = problem(s)
        return sie.solve(equation, zones, tol=1e-12, **more)

    around = [solved(k * STEP) for k in (-2, -1, 1, 2)]
    found = solved(0.0).derivative(**change)

    def agree(exact, of):
        values = [np.asarray(of(one)) for one in around]
        difference = (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * STEP)
        size = max(np.abs(difference).max(initial=0.0), 1.0)
        assert np.abs(np.asarray(exact) - difference).max(initial=0.0) < 1e-8 * size

    x = np.array(x)
    agree(found.ends, lambda one: one.zones.table)
    agree(found.density(x), lambda one: one.density(x))
    agree(found.intensities, lambda one: np.array(one.density.intensities))
    agree(found.density.totals, lambda one: one.density.totals)
    agree(found.amplitudes, lambda one: one.amplitudes)
    if found.value is not None:
        agree(found.value, lambda one: one.value)
    if "dkernel" not in change:
        agree(found.density.transform(PLANE), lambda one: one.density.transform(PLANE))
        agree(found.density.potential(PLANE), lambda one: one.density.potential(PLANE))
        agree(found.density.potential(x), lambda one: one.density.potential(x))
        agree(found.density.transform_slope(PLANE), lambda one: one.density.transform_slope(PLANE))


def test_derivatives_add_up():
    equation, zones, _ = cracks(0.0)
    found = sie.solve(equation, zones)
    one, two = {"dg": np.cos, "values": [0.3]}, {"dends": TWO_ENDS}
    both = found.derivative(**one, **two).density
    apart = [found.derivative(**change).density for change in (one, two)]
    x = np.array([-0.5, 0.1, 1.4, 0.7])
    assert np.abs(both.transform(x) - apart[0].transform(x) - apart[1].transform(x)).max() < 1e-12
    assert np.abs(both(x) - apart[0](x) - apart[1](x)).max() < 1e-12


@pytest.mark.parametrize(
    ("conditions", "right", "values"),
    [
        ((sie.ZoneTotals(1.0),), sie.SINGULAR, [0.5]),
        ((sie.Total(1.0), sie.EqualPotential()), sie.SINGULAR, [1.0, 0.0]),
        ((), sie.BOUNDED, None),
        (
            (sie.ZoneTotals(1.0), sie.Weighted(lambda x: np.cos(9 * x), 0.3)),
            sie.SINGULAR,
            [1.0, 0.5],
        ),
    ],
)
def test_factors_and_iteration_give_the_same_derivative(conditions, right, values):
    rng = np.random.default_rng(3)
    ends = 1.3 * np.arange(60)[:, None] + [0.0, 1.0] + rng.uniform(-0.1, 0.1, (60, 2))
    g = sie.Forcing(np.sin, lambda x: -np.cos(x))
    weighted = any(isinstance(one, sie.Weighted) for one in conditions)
    columns = [lambda x: np.exp(-x / 10)] if weighted else []
    equation = sie.Equation(sie.cauchy(), g, conditions, columns)
    zones, dends = sie.Zones.of(ends, sie.SINGULAR, right), rng.uniform(-1, 1, (60, 2))
    found = []
    for direct in (True, False):
        state = without_slits(sie.solve_fixed(equation, zones, direct=direct), None)
        assert state.iterated is not direct
        dg = sie.Forcing(np.cos, np.sin)
        change = Change.of(state, dg, values, None, dends, None)
        found.append(Linearized(state, change).derivative())
    one, two = found
    x = ends.mean(axis=1) + 0.1
    assert np.abs(one.intensities - two.intensities).max() < 1e-10 * np.abs(one.intensities).max()
    assert np.abs(one.density(x) - two.density(x)).max() < 1e-10 * np.abs(one.density(x)).max()


@pytest.mark.parametrize("load", [1.0, 1.55, 1.5702])
def test_two_zones_of_a_quartic_profile_follow_their_load(load):
    """phi = |x| sqrt((a^2 - x^2)(x^2 - b^2)) with a^2 = 1 + e, b^2 = 1 - e, e^2 = 2 P / pi.

    At the last load, `solve` treats the narrow gap as a slit. The derivative is then computed
    from a solution without slits.
    """
    g = sie.Forcing(lambda x: x * (x * x - 1), lambda x: x**4 / 4 - x * x / 2)
    equation = sie.Equation(sie.cauchy(), g, (sie.Total(load), sie.EqualPotential()))
    found = sie.solve(equation, sie.Zones.of([[-1.4, -0.1], [0.1, 1.4]]))
    assert type(found.density) is (sie.SlitDensity if load > 1.57 else sie.Density)
    e = np.sqrt(2 * load / np.pi)
    a, b = 1 / (2 * np.pi * e * np.sqrt(1 + e)), -1 / (2 * np.pi * e * np.sqrt(1 - e))
    ends = found.derivative(values=[1.0, 0.0]).ends
    assert np.abs(ends / [[-a, -b], [b, a]] - 1).max() < 1e-7


CLOSE = [[-2.0, -1e-7], [1e-7, 2.0]]


def close_plates(s):
    g = sie.Forcing(
        lambda x: np.cos(x) + s * np.sin(2 * x), lambda x: np.sin(x) - s * np.cos(2 * x) / 2
    )
    equation = sie.Equation(sie.cauchy(), g, (sie.Total(1.0 + s), sie.EqualPotential()))
    return equation, sie.Zones.of(CLOSE, *SINGULAR)


def close_cracks(s):
    conditions = sie.ZoneTotals(s), sie.Amplitude(0, 0.1 + s)
    g = sie.Forcing(lambda x: np.cos(x) + s * np.sin(2 * x))
    equation = sie.Equation(sie.hilbert(5.0), g, conditions, np.exp)
    return equation, sie.Zones.of(CLOSE, *SINGULAR)


def close_punches(s):
    g = sie.Forcing(lambda x: 1.2 * x + 0.9 + s * np.sin(2 * x))
    equation = sie.Equation(sie.cauchy(), g, sie.ZoneTotals((1.0, 0.7)))
    zones = [[-2.5, -1e-7], [1e-7, 2.0]]
    kinds = [sie.FREE, sie.SINGULAR], [sie.SINGULAR, sie.FREE]
    return equation, sie.Zones.of(zones, *kinds)


def close_kinks(s):
    g = sie.Forcing(lambda x: np.cos(x) + s * np.sign(x - 0.1), jumps=sie.Jumps([0.1], [2.0 * s]))
    return sie.Equation(sie.cauchy(), g, sie.ZoneTotals(0.3)), sie.Zones.of(CLOSE, *SINGULAR)


@pytest.mark.parametrize(
    ("problem", "values"),
    [
        (close_kinks, None),
        (close_plates, [1.0, 0.0]),
        (close_cracks, [1.0, 1.0]),
        (close_punches, None),
    ],
)
def test_derivatives_beside_narrow_gaps_are_the_limits_of_differences(problem, values):
    h = 1e-3
    around = [sie.solve(*problem(k * h), tol=1e-8) for k in (-2, -1, 1, 2)]
    found = sie.solve(*problem(0.0), tol=1e-8)
    assert type(found.density) is sie.GradedDensity
    dg = sie.Forcing(lambda x: np.sin(2 * x), lambda x: -np.cos(2 * x) / 2)
    dg = KINK if problem is close_kinks else dg
    derivative = found.derivative(dg, values=values)
    x = np.array([-1.5, -1e-3, 0.3, 1.5])
    for exact, of in [
        (derivative.density(x), lambda one: one.density(x)),
        (derivative.density.transform(PLANE), lambda one: one.density.transform(PLANE)),
        (derivative.intensities, lambda one: np.array(one.density.intensities)),
        (derivative.ends, lambda one: one.zones.table),
        (derivative.amplitudes, lambda one: one.amplitudes),
    ]:
        j = [np.asarray(of(one)) for one in around]
        difference = (j[0] - 8 * j[1] + 8 * j[2] - j[3]) / (12 * h)
        size = max(np.abs(difference).max(initial=0.0), 1.0)
        assert np.abs(exact - difference).max(initial=0.0) < 1e-7 * size
    with pytest.raises(ValueError, match="too narrow"):
        found.derivative(dends=[[-1.0, 0.0], [0.0, 0.0]])


def test_the_capacity_of_plates_that_nearly_touch():
    found = sie.solve(
        sie.Equation(
            sie.cauchy(),
            sie.Forcing(np.zeros_like, np.zeros_like),
            (sie.Total(1.0), sie.EqualPotential()),
        ),
        sie.Zones.of([[-1.0, -1e-7], [1e-7, 1.0]], *SINGULAR),
        tol=1e-8,
    )
    assert abs(found.capacity - 0.5) < 1e-8
    lines = str(found.report()).splitlines()
    assert len(lines) == 5 and np.abs(found.residual([-0.5, 1e-5])).max() < 1e-9


def test_wrong_changes_are_refused_with_their_reason():
    equation, zones, _ = cracks(0.0)
    found = sie.solve(equation, zones)
    for change, message in [
        ({"values": [1.0, 2.0]}, "one entry for each of the 1 conditions"),
        ({"values": [[1.0, 2.0, 3.0]]}, "has 2 rows"),
        ({"dends": [1.0, 2.0]}, "of shape"),
        ({"dintensities": np.ones((2, 2))}, "singular ends"),
        ({"dg": 3.0}, "must be a function"),
        ({"dg": np.sign}, "not resolved"),
        ({"dg": lambda x: 1 / (x - 0.1)}, "not finite, or not resolved|not resolved"),
        ({"dkernel": lambda x, xi: np.abs(x - xi)}, "not resolved"),
        ({"dkernel": 1.0}, "function of"),
    ]:
        with pytest.raises(ValueError, match=message):
            found.derivative(**change)
    free_ends = sie.solve(*free(0.0)[:2])
    with pytest.raises(ValueError, match="free ends follow"):
        free_ends.derivative(dends=np.ones((2, 2)))
    with pytest.raises(ValueError, match="primitive"):
        free_ends.derivative(np.cos)
    wide = sie.solve(of_width(0.0)[0], of_width(0.0)[1], value=1.0)
    with pytest.raises(ValueError, match="unknown"):
        wide.derivative(values=[1.0, 0.0])


def integral(solution, weight, nodes=400):
    """int weight phi dx by Gauss's rule in the angle."""
    zones, theta = solution.zones, (np.arange(nodes) + 0.5) * np.pi / nodes
    t = np.cos(theta)
    return sum(
        np.pi
        * half
        * np.mean(weight(middle + half * t) * solution.density.at_t(i, t) * np.sin(theta))
        for i, (middle, half) in enumerate(zip(zones.middle, zones.half, strict=True))
    )


@pytest.mark.parametrize(
    ("problem", "change", "x"),
    [one for one in PROBLEMS if one[0] is not mirrored],
    ids=lambda p: getattr(p, "__name__", ""),
)
def test_a_gradient_gives_the_derivative_of_its_functional(problem, change, x):
    """The gradient comes from one adjoint solve. Its product with the changes of the data agrees
    with a difference quotient of fourth order, computed from four solutions.
    """
    equation, zones, more = problem(0.0)
    found = sie.solve(equation, zones, tol=1e-12, **more)
    rng = np.random.default_rng(5)
    singular = np.isnan(zones.intensities)
    of_k = np.where(singular, rng.uniform(-1, 1, singular.shape), 0.0)
    of_ends = rng.uniform(-1, 1, (len(zones), 2))
    weight = np.ones_like if problem is kinked else (lambda x: np.cos(3 * x) + x)

    def functional(s):
        equation, zones, more = problem(s)
        one = sie.solve(equation, zones, tol=1e-12, **more)
        edges = (of_k * np.array(one.density.intensities)).sum()
        mean = one.density.total if problem is kinked else integral(one, weight)
        return edges + (of_ends * one.zones.table).sum() + mean

    j = [functional(k * STEP) for k in (-2, -1, 1, 2)]
    difference = (j[0] - 8 * j[1] + 8 * j[2] - j[3]) / (12 * STEP)
    by_data = found.gradient(weight, intensities=of_k, ends=of_ends)
    names = (*equation.conditions, *equation.end_conditions)
    given = change.get("values", [0.0] * len(names))
    out = sum(
        (row * value).sum() for row, value in zip(by_data.values, np.atleast_1d(given), strict=True)
    )
    out += (by_data.ends * change.get("dends", 0.0)).sum()
    out += (by_data.intensities * change.get("dintensities", 0.0)).sum()
    out += by_data(change.get("dg"), change.get("dkernel"))
    assert abs(out - difference) < 1e-8 * max(abs(difference), 1.0)


def test_a_solution_by_iteration_has_a_gradient_too():
    still = sie.Equation(sie.cauchy(), np.cos, sie.ZoneTotals(1.0))
    many = sie.Zones.of(1.3 * np.arange(60)[:, None] + [0.0, 1.0], *SINGULAR)
    found = sie.solve(still, many)
    assert found.state.iterated
    rng = np.random.default_rng(7)
    of_k, dends = rng.uniform(-1, 1, (2, 60)), rng.uniform(-1, 1, (60, 2))
    exact = (of_k * found.derivative(dends=dends).intensities).sum()
    assert abs((found.gradient(intensities=of_k).ends * dends).sum() / exact - 1) < 1e-10


def test_a_gradient_that_is_not_defined_is_refused():
    equation, zones, _ = mirrored(0.0)
    with pytest.raises(ValueError, match="symmetric=False"):
        sie.solve(equation, zones).gradient(np.cos)
    found = sie.solve(*free(0.0)[:2])
    with pytest.raises(ValueError, match="singular ends"):
        found.gradient(intensities=np.ones((2, 2)))
    with pytest.raises(ValueError, match="weight must be a function"):
        found.gradient(3.0)
