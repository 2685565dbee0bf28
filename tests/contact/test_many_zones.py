"""Many zones: fast sums against a matrix, equal zones, and the work of the iterations."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest

import contact
import sie
from contact.reference.exact import Westergaard
from contact.search.grid import nested_grids
from contact.search.strategies import guesses
from contact.search.topology import loop
from sie.fast.iteration import Iterative
from sie.fast.system import IterativeSystem
from sie.slits import slits as cuts
from sie.states.solve import SolveOptions
from tests.tiers import quick

T = np.array([-0.99, -0.6, 0.0, 0.4, 0.95])


def rough(kmax, seed=1):
    """A periodic self-affine scene: Hurst exponent 0.8, harmonics 4 to kmax, rms slope 0.1."""
    k = np.arange(4, kmax + 1)
    phase = np.random.default_rng(seed).uniform(0, 2 * np.pi, len(k))
    amplitude = k**-1.3
    amplitude *= 0.1 / np.sqrt(0.5 * np.sum((2 * np.pi * k * amplitude) ** 2))
    cosine, sine = np.zeros(kmax), np.zeros(kmax)
    cosine[3:], sine[3:] = amplitude * np.cos(phase), amplitude * np.sin(phase)
    return contact.Scene(
        contact.Fourier(1.0, cosine, sine), 1.0, contact.Periodic(), mean_pressure=0.005
    )


def solve(scene, monkeypatch, unknowns, tol=1e-9):
    """The solution, with fast sums from `unknowns` unknowns on and with a matrix below."""
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=unknowns))
    return contact.solve(scene, tol=tol)


def test_fast_sums_give_what_a_matrix_gives(monkeypatch):
    scene = rough(400)
    direct, fast = solve(scene, monkeypatch, 10**9), solve(scene, monkeypatch, 10)
    assert not direct.plan["fast sums"].used and fast.plan["fast sums"].used
    assert len(direct.zones) == len(fast.zones) > 30
    width = np.diff(direct.zones, axis=1)
    bound = direct.error + fast.error
    assert np.abs((direct.zones - fast.zones) / width).max() <= bound
    for zone in range(len(width)):
        difference = np.abs(direct.pressure_at(T, zone) - fast.pressure_at(T, zone)).max()
        assert difference <= bound * direct.max_pressure
    x = np.linspace(0, 1, 301)
    assert fast.gap(x) == pytest.approx(direct.gap(x), abs=1e-10)


@pytest.mark.parametrize("zones", [64, 301])
def test_equal_waves_in_one_period_are_each_the_wave_alone(zones):
    """The profile has one harmonic, so all zones are equal; round-off must not make them differ."""
    cosine = np.zeros(zones)
    cosine[-1] = -1e-3 / zones
    truth = Westergaard(
        amplitude=1e-3 / zones, period=1 / zones, E_star=1.0, half_width=0.15 / zones
    )
    scene = contact.Scene(
        contact.Fourier(1.0, cosine, 0 * cosine),
        1.0,
        contact.Periodic(),
        mean_pressure=truth.mean_pressure,
    )
    solution = contact.solve(scene, tol=1e-8)
    assert len(solution.zones) == zones and solution.certificate.holds
    assert solution.zone_widths == pytest.approx(0.3 / zones, rel=1e-8)
    assert solution.zone_loads == pytest.approx(truth.load, rel=1e-8)
    spread = np.array([solution.pressure_at(T, zone) for zone in range(zones)])
    assert np.abs(spread - truth.pressure_at(T)).max() <= solution.error * truth.max_pressure


def test_iterations_do_not_grow_with_the_zones(monkeypatch):
    """The coarse problem of GMRES solves for the loads of the zones.

    The rest of the interaction couples neighbours only. So the number of iterations does not grow
    with the number of zones.
    """
    steps, counts = [], []
    original = Iterative.__call__

    def counted(self, *given, **options):
        before = self.iterations
        out = original(self, *given, **options)
        steps.append(self.iterations - before)
        return out

    monkeypatch.setattr(Iterative, "__call__", counted)
    first = []
    for kmax in (400, 3200):
        steps.clear()
        counts.append(len(solve(rough(kmax), monkeypatch, 10, 1e-8).zones))
        # The first solution starts from zero; its tolerance is the same for both scenes.
        first.append(steps[0])
    assert counts[1] > 4 * counts[0]
    assert first[1] <= 1.3 * first[0] + 2


def test_the_highest_harmonic_changes_the_solution(monkeypatch):
    whole = solve(rough(300), monkeypatch, 10)
    less = contact.Fourier(1.0, whole.scene.profile.cosine[:-1], whole.scene.profile.sine[:-1])
    part = contact.solve(
        contact.Scene(less, 1.0, contact.Periodic(), mean_pressure=0.005), tol=1e-9
    )
    assert abs(part.max_pressure / whole.max_pressure - 1) > 1e-6


def test_long_sums_are_exact_at_the_place_given():
    """The slopes of 5,000 harmonics vary over a ten thousandth of the period.

    A rounded x/L would cause errors in the twelfth digit.
    """
    rng, count, period = np.random.default_rng(4), 5000, 0.3
    k = np.arange(1, count + 1)
    profile = contact.Fourier(
        period, rng.standard_normal(count) / k, rng.standard_normal(count) / k
    )
    x = np.array([0.1234567, -0.1477, 0.05])
    slopes = []
    with mpmath.workdps(30):
        for place in x:
            turn = mpmath.expj(2 * mpmath.pi * mpmath.mpf(place) / mpmath.mpf(period))
            powers, term = [], mpmath.mpc(1)
            for _ in range(count):
                term *= turn
                powers.append(term)
            waves = [2 * mpmath.pi / mpmath.mpf(period) * int(n) for n in k]
            slopes.append(
                float(
                    mpmath.fsum(
                        w * (s * p.real - c * p.imag)
                        for w, c, s, p in zip(
                            waves, profile.cosine, profile.sine, powers, strict=True
                        )
                    )
                )
            )
    size = 2 * np.pi / period * np.sqrt(np.sum(k**2 * (profile.cosine**2 + profile.sine**2)))
    assert profile.slope(x) == pytest.approx(slopes, abs=3e-15 * size)


def test_narrow_gaps_among_many_zones_cost_the_iteration_nothing(monkeypatch):
    """With slits (narrow gaps inside wide zones) the zones are the same as without.

    The slits are part of the rows of the system, so the number of iterations hardly grows.
    """
    scene = rough(1200)
    with_slits = solve(scene, monkeypatch, 10, 1e-8)
    monkeypatch.setattr(cuts, "OPTIONS", replace(cuts.OPTIONS, max_gap=0.0))
    without = solve(scene, monkeypatch, 10, 1e-8)
    assert with_slits.plan["slits"].used and not without.plan["slits"].used
    width = np.diff(with_slits.zones, axis=1)
    assert (
        np.abs((with_slits.zones - without.zones) / width).max() <= with_slits.error + without.error
    )
    x = np.linspace(-0.5, 0.5, 501)
    assert with_slits.gap(x) == pytest.approx(without.gap(x), abs=1e-12)
    counts = [int(one.plan["fast sums"].detail.split()[0]) for one in (with_slits, without)]
    assert counts[0] <= 1.3 * counts[1]


def test_a_given_total_width_takes_less_than_three_times_the_iterations_of_a_given_load(
    monkeypatch,
):
    """A given total width also needs the response of the density to the load.

    This response is computed only as accurately as a Newton step needs it.
    """
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10))
    scene = replace(rough(400), E_star=2.0, mean_pressure=0.01)
    solution, profile = contact.solve(scene, tol=1e-10), scene.profile
    counts, once = [], Iterative.__call__

    def counted(self, *given, **named):
        before = self.iterations
        out = once(self, *given, **named)
        counts[-1] += self.iterations - before
        return out

    monkeypatch.setattr(Iterative, "__call__", counted)
    forcing = sie.Forcing(profile.slope, profile.height, resolution=sie.Resolution(length=1 / 400))
    width = float(np.diff(solution.zones).sum())
    start = sie.Zones.of(solution.zones + 0.01 * np.diff(solution.zones) * np.array([0.4, -0.7]))
    for total, ends in (
        (sie.Total(solution.load), ()),
        (sie.Total(None), (sie.TotalWidth(width),)),
    ):
        counts.append(0)
        problem = sie.Equation(sie.hilbert(1.0), forcing, (total, sie.EqualPotential()), (), ends)
        found = sie.find_ends(problem, start, 1e-9, start=sie.WarmStart(value=0.9 * solution.load))
        assert found.converged and found.state.iterated
    assert found.value == pytest.approx(solution.load, rel=1e-8)
    assert counts[1] < 3 * counts[0], counts


def test_the_first_steps_use_rough_sums_and_the_final_solution_does_not(monkeypatch):
    """Rough sums are allowed at first; after the first system with accurate sums, none is rough."""
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10))
    seen, summed = [], IterativeSystem.applied

    def told(self, y, rough=False):
        seen.append((self, self.rough))
        return summed(self, y, rough)

    monkeypatch.setattr(IterativeSystem, "applied", told)
    assert contact.solve(rough(400), tol=1e-8).certificate.holds
    each = list(dict(seen).values())
    assert each[0] and not each[-1] and each == sorted(each, reverse=True)


def solved_with_its_equation(tol):
    """(Solution of a rough contact with E*/2 = 1, its equation for the engine `sie`)."""
    scene = replace(rough(400), E_star=2.0, mean_pressure=0.01)
    solution, profile = contact.solve(scene, tol=tol), scene.profile
    forcing = sie.Forcing(profile.slope, profile.height, resolution=sie.Resolution(length=1 / 400))
    return solution, sie.Equation(
        sie.hilbert(1.0), forcing, (sie.Total(solution.load), sie.EqualPotential())
    )


def test_ends_that_are_known_well_are_found_accurately_at_once(monkeypatch):
    """If the small error of the first ends is given, Newton's method needs fewer steps."""
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10))
    solution, equation = solved_with_its_equation(1e-10)
    start = sie.Zones.of(solution.zones + 1e-6 * np.diff(solution.zones) * np.array([0.4, -0.7]))
    plain, told = (
        sie.find_ends(equation, start, 1e-7, start=sie.WarmStart(initial_error=error))
        for error in (1.0, 1e-6)
    )
    assert plain.converged and told.converged and len(told.trace) < len(plain.trace)
    width = np.diff(plain.density.zones.table, axis=1)
    assert np.all(
        np.abs(told.density.zones.table - plain.density.zones.table)
        <= (told.end_error + plain.end_error) * width
    )


def test_a_profile_with_very_many_features_has_a_grid_half_as_fine_per_feature(monkeypatch):
    sizes = []

    def sized(f, influence, **asked):
        sizes.append(influence.n)
        return once(
            np.cos(2 * np.pi * np.arange(64) / 64), influence.periodic(64, 1 / 64, 1.0), load=0.1
        )

    once = nested_grids.solve_grid
    monkeypatch.setattr(nested_grids, "solve_grid", sized)
    monkeypatch.setattr(nested_grids, "_refine", lambda p, periodic: p)
    for features in (2**14, 2**15, 2**16):
        nested_grids.propose(
            np.cos, (0.0, 1.0), nested_grids.Response(1.0), load=0.1, resolution=1 / features
        )
    assert [n for n, after in zip(sizes, [*sizes[1:], 64], strict=True) if after <= n] == [
        2**18,
        2**19,
        2**19,
    ]


@pytest.mark.parametrize("lacking", quick([[3, 9, 17, 25], [3]], [[3, 9, 17, 25]]))
def test_the_search_with_very_many_zones_begins_with_rough_ends(monkeypatch, lacking):
    """While zones are missing, the ends are found with the rough tolerance only."""
    monkeypatch.setattr(loop, "ROUGH", loop.RoughRoundOptions(min_intervals=20))
    proposed, asked = guesses.proposed, []

    def left_out(*given, **named):
        proposal = proposed(*given, **named)
        return replace(proposal, zones=np.delete(proposal.zones, lacking, axis=0))

    monkeypatch.setattr(guesses, "proposed", left_out)
    original = sie.find_ends

    def found(equation, zones, tolerance, *given, **named):
        asked.append((tolerance, len(zones)))
        return original(equation, zones, tolerance, *given, **named)

    monkeypatch.setattr(sie, "find_ends", found)
    scene = rough(400)
    solution = contact.solve(scene, tol=1e-9)
    assert [tolerance for tolerance, _ in asked[:-1]] == [loop.SEARCH.rough]
    assert asked[-1][0] < loop.SEARCH.rough and len(solution.zones) != asked[0][1]
    monkeypatch.undo()
    plain = contact.solve(scene, tol=1e-9)
    assert (
        np.abs((solution.zones - plain.zones) / np.diff(plain.zones)).max()
        <= solution.error + plain.error
    )


def test_ends_and_their_remainders_move_with_a_profile_shifted_by_a_quarter_period():
    """A shift by a quarter of the period multiplies the harmonics by exact factors.

    So the zones agree to more digits than their positions have as single numbers; the remainders
    hold the further digits.
    """
    scene = rough(1200)
    profile = scene.profile
    c = (np.asarray(profile.cosine) - 1j * np.asarray(profile.sine)) * np.array([1, -1j, -1, 1j])[
        np.arange(1, 1201) % 4
    ]
    here, moved = (
        contact.solve(replace(scene, profile=one), tol=1e-9)
        for one in (profile, contact.Fourier(1.0, c.real, -c.imag))
    )
    order = np.argsort((here.zones[:, 0] + 0.75) % 1.0)
    apart = moved.zones - here.zones[order] - 0.25
    apart = (apart - np.round(apart)) + (moved.zone_remainders - here.zone_remainders[order])
    assert np.any(here.zone_remainders != 0.0)
    assert np.abs(apart / here.zone_widths[order, None]).max() <= here.error + moved.error
    assert here.zone_widths[order] == pytest.approx(
        moved.zone_widths, rel=2 * (here.error + moved.error), abs=0
    )


def test_a_refined_grid_has_no_pressure_in_cells_beyond_an_end():
    """The square-root law of the pressure locates the ends.

    New cells outside these ends have no pressure, so the contact keeps its width.
    """
    counts = []
    for n in (256, 512):
        x = (np.arange(n) + 0.5) / n
        p = np.maximum(np.cos(2 * np.pi * x) ** 2 - np.sin(2 * np.pi * 0.21) ** 2, 0.0) ** 0.5
        counts.append(np.count_nonzero(p))
        if n == 256:
            finer = nested_grids._refine(p, True)
    assert abs(np.count_nonzero(finer) - counts[1]) <= 4
    assert finer.sum() / 2 == pytest.approx(p.sum() / 2, rel=0.01)


def test_a_rough_search_for_the_ends_takes_at_most_three_steps(monkeypatch):
    """The check of the signs corrects the ends that have not converged by then."""
    monkeypatch.setattr(loop, "ROUGH", loop.RoughRoundOptions(min_intervals=20))
    looks, original = [], sie.find_ends

    def found(equation, zones, tolerance, *given, **named):
        looks.append((tolerance, original(equation, zones, tolerance, *given, **named)))
        return looks[-1][1]

    monkeypatch.setattr(sie, "find_ends", found)
    assert contact.solve(rough(400), tol=1e-9).certificate.holds
    loose = [len(free.trace) for tolerance, free in looks if tolerance == loop.SEARCH.rough]
    assert loose and max(loose) <= 3


def test_a_search_can_start_from_the_modes_of_the_last_search(monkeypatch):
    """On nearly the same zones, a start from the last solution saves 40 % of the iterations."""
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10))
    solution, equation = solved_with_its_equation(1e-8)
    beside = sie.Zones.of(solution.zones + 1e-5 * np.diff(solution.zones) * np.array([0.4, -0.7]))
    left = sie.find_ends(equation, sie.Zones.of(solution.zones), 1e-7).state.sizes
    fresh, after = (
        sie.find_ends(
            equation, beside, 1e-7, sie.NewtonOptions(max_steps=0), sie.WarmStart(modes_like=like)
        ).state.sizes
        for like in (None, left)
    )
    assert after.iterations < 0.6 * fresh.iterations
