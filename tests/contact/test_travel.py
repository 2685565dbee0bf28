"""Solutions, plans and errors can be pickled and copied. The copies have bitwise the same
numbers, also in another process. A pickle holds no cached results.
"""

from __future__ import annotations

import copy
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import contact
import sie
from contact import axisymmetric
from contact.reference import exact

WAVE = contact.Sinusoid(1e-3, 1.0)
PERIODIC = contact.Periodic()
_random = np.random.default_rng(3)
ROUGH = contact.Sampled(
    (np.arange(40) + _random.uniform(-0.3, 0.3, 40)) / 40, 1e-3 * _random.normal(size=40), 1.0
)
WAVES = contact.Fourier(1.0, [0.0] * 59 + [-2e-5], [1e-7])
SCENES = {
    "hertz": contact.Scene(contact.Parabola(1.0), 1.0, contact.Isolated(datum=3.0), load=1e-3),
    "tilted": contact.Scene(contact.Flat(1.0), 1.0, contact.Isolated(), load=1e-2, moment=3e-3),
    "moment of a polynomial": contact.Scene(
        contact.Polynomial([0, 0.1, 1.0, 0.5, 1.0]),
        1.0,
        contact.Isolated(datum=2.0),
        load=1e-3,
        moment=1e-5,
    ),
    "wave": contact.Scene(WAVE, 1.0, PERIODIC, load=5e-4),
    "gap": contact.Scene(WAVE, 1.0, PERIODIC, load=3e-3),
    "full": contact.Scene(WAVE, 1.0, PERIODIC, load=5e-3),
    "corner in a gap": contact.Scene(
        contact.Polynomial([0, -1.0, 1.0, 1.0], 2.0), 1.0, PERIODIC, mean_pressure=0.5
    ),
    "wedge": contact.Scene(contact.Wedge(0.1, 1.0), 1.0, PERIODIC, load=1e-2),
    "two tips close": contact.Scene(
        contact.Biquadratic(1.0, 0.4, 1.0), 1.0, PERIODIC, mean_pressure=9.9e-3
    ),
    "first order": contact.Scene(WAVE, 1.0, contact.Localized(), load=5e-4),
    "self-consistent": contact.Scene(
        WAVE, 1.0, contact.Localized("self-consistent", neighbours=2), load=5e-4
    ),
    "trace": contact.Scene(ROUGH, 1.0, PERIODIC, mean_pressure=2e-3),
    "many zones": contact.Scene(WAVES, 1.0, PERIODIC, mean_pressure=1e-4),
}


@pytest.fixture(scope="module", params=SCENES)
def solution(request):
    return contact.solve(SCENES[request.param])


def numbers_of(solution):
    """Returns the fields at some positions and all numbers of a solution, as bytes."""
    rng = np.random.default_rng(0)
    zones = solution.zones if len(solution.zones) else np.array([[-0.5, 0.5]])
    x = rng.uniform(zones[0, 0] - 0.3, zones[-1, 1] + 0.3, 40)
    told = [
        np.asarray(field(x)) for field in (solution.pressure, solution.gap, solution.displacement)
    ]
    told += [solution.pressure_at(np.linspace(-1, 1, 9), k) for k in range(len(solution.zones))]
    names = (
        "zones",
        "load",
        "mean_pressure",
        "zone_loads",
        "zone_widths",
        "max_pressure",
        "approach",
        "contact_fraction",
        "stiffness",
        "tilt",
        "moment",
        "rotational_stiffness",
        "mean_gap",
        "error",
    )
    told += [
        np.asarray(np.nan if (value := getattr(solution, name)) is None else value)
        for name in names
    ]
    return b"".join(values.tobytes() for values in told)


def test_copies_of_a_solution_are_bitwise_equal(solution):
    before = pickle.dumps(solution)
    for again in (
        pickle.loads(before),
        copy.deepcopy(solution),
        copy.copy(solution),
        pickle.loads(pickle.dumps(pickle.loads(before))),
    ):
        assert numbers_of(again) == numbers_of(solution)
        assert (
            str(again.plan) == str(solution.plan)
            and again.certificate.holds == solution.certificate.holds
        )
        assert again.scene == solution.scene


def test_cached_results_are_not_pickled(solution):
    fresh = len(pickle.dumps(solution))
    numbers_of(solution)
    assert len(pickle.dumps(solution)) <= fresh + 64


def test_the_size_of_a_pickle_is_bounded_by_its_count_of_numbers(solution):
    # The numbers of a solution are its modes, its jumps and its zone ends, which are kept for
    # every step of the search, too. Names take the rest, at most 6000 bytes.
    held = solution.plan.counts.get("own_modes", 0) + 2 * len(solution.zones) * (
        4 + len(solution.trace)
    )
    jumps = len(solution.scene.profile.kinks) + len(solution.scene.profile.jumps)
    profile = len(pickle.dumps(solution.scene.profile))
    assert len(pickle.dumps(solution)) <= 6000 + profile + 8 * 4 * (held + 8 * jumps)


def solved_and_told(scene):
    found = contact.solve(scene)
    return found, numbers_of(found)


def refused(scene):
    return contact.solve(scene, tol=1e-13)


# At this approach the gap is a millionth of the period. A change of the last digit of the
# approach changes the load by more than the tolerance.
SHALLOW = contact.Scene(
    contact.Wedge(0.1, 1.0),
    1e9,
    PERIODIC,
    approach=exact.PeriodicWedge(0.1, 1.0, 1e9, 0.5 * (1 - 1e-6)).approach,
)


@pytest.mark.slow
def test_solutions_and_errors_come_back_from_other_processes():
    names = ("hertz", "gap", "wedge", "first order", "trace")
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        for name in names:
            found, told = pool.submit(solved_and_told, SCENES[name]).result()
            assert numbers_of(found) == told
            # The solution is also sent back to the other process.
            assert pool.submit(numbers_of, found).result() == told
        with pytest.raises(contact.NotConverged) as failure:
            pool.submit(refused, SHALLOW).result()
    assert failure.value.best.zones.shape == (1, 2) and failure.value.trace


def test_pickled_errors_keep_their_attributes():
    with pytest.raises(contact.NotConverged) as failure:
        contact.solve(SHALLOW)
    error = failure.value
    for again in (pickle.loads(pickle.dumps(error)), copy.deepcopy(error), copy.copy(error)):
        assert str(again) == str(error) and len(again.trace) == len(error.trace)
        assert numbers_of(again.best) == numbers_of(error.best)
    for raised in (
        contact.SceneError.of("load", -1.0, "positive"),
        contact.OutOfRange("past full contact"),
        contact.MissingExtra("plot"),
    ):
        again = pickle.loads(pickle.dumps(raised))
        assert (
            type(again) is type(raised)
            and str(again) == str(raised)
            and again.__dict__ == raised.__dict__
        )


def test_plans_and_paths_can_be_pickled():
    plan = contact.plan(SCENES["wave"])
    assert str(pickle.loads(pickle.dumps(plan))) == str(copy.deepcopy(plan)) == str(plan)
    path = contact.path(SCENES["wave"], [1e-4, 5e-4])
    again = pickle.loads(pickle.dumps(path))
    assert [numbers_of(s) for s in again.solutions] == [numbers_of(s) for s in path.solutions]


def test_a_pickled_solution_serves_as_a_first_guess():
    first = contact.solve(SCENES["trace"])
    scene = contact.Scene(ROUGH, 1.0, PERIODIC, mean_pressure=2.02e-3)
    near, far = (
        contact.solve(scene, near=guess) for guess in (first, pickle.loads(pickle.dumps(first)))
    )
    assert np.array_equal(near.zones, far.zones)


@pytest.mark.parametrize(
    "kernel",
    [
        sie.hilbert(3.0),
        sie.hilbert(3.0) + sie.Smooth(np.subtract),
        sie.cauchy(),
        sie.images(3.0, 2),
    ],
)
def test_kernels_and_densities_of_the_engine_can_be_pickled(kernel):
    zones = sie.Zones.of([[-0.6, 0.2], [0.5, 0.9]])
    equation = sie.Equation(
        sie.hilbert(3.0), sie.Forcing(np.sin), (sie.Total(1.0), sie.moment(0.1))
    )
    state = sie.solve_fixed(equation, zones)
    x = np.linspace(-1.4, 1.4, 30)
    plainly = sie.Density(
        zones, kernel, state.density.coefficients, state.density.jumps, np.zeros(0)
    )
    for density in (state.density, plainly.with_bounded_ends()):
        for again in (pickle.loads(pickle.dumps(density)), copy.deepcopy(density)):
            assert np.array_equal(again(x), density(x)) and np.array_equal(
                again.transform(x), density.transform(x)
            )
            assert np.array_equal(again.intensities, density.intensities)
    assert pickle.loads(pickle.dumps(kernel)) == kernel


def test_round_spots_can_be_pickled():
    for lattice, rings in ((None, 0), (axisymmetric.Square(1.0), 2)):
        spot = axisymmetric.solve_spot(
            axisymmetric.PowerLaw(1.0, 3.0), 1.0, lattice, load=1e-3, rings=rings
        )
        r, again = np.linspace(0, 0.3, 9), pickle.loads(pickle.dumps(spot))
        assert (
            again.pressure(r).tobytes() == spot.pressure(r).tobytes()
            and again.gap(r).tobytes() == spot.gap(r).tobytes()
        )
