"""Fast sums give the results of the assembled matrix, for any widths and distances of the zones.
Their cost is proportional to the number of zones.
"""

import gc
import weakref

import numpy as np
import pytest

import sie
from sie.dense import modes
from sie.dense.system import MirrorSymmetry, System
from sie.density.treecode import Treecode
from sie.fast.coarse import CoarseOperator
from sie.fast.system import IterativeSystem
from sie.fast.zone_sums import Nested, ZoneSums
from sie.jumps.right_side import ForcingJumps
from sie.trees.far import FarSum
from sie.trees.hierarchical import Inverse, cross_approximation
from sie.trees.krylov import gmres
from sie.trees.tree import SEPARATION, TERMS, Tree, interactions
from tests.tiers import diagonal

KERNELS = {"line": sie.cauchy(), "period": sie.hilbert(1.0), "images": sie.images(1.2, 2)}


def scattered(count, rng, decades=2.5):
    """Ascending zones in (-0.45, 0.45), whose widths and gaps vary over `decades` decades."""
    lengths = 10 ** rng.uniform(-decades, 0.0, 2 * count - 1)
    ends = np.concatenate(([0.0], np.cumsum(lengths)))
    return sie.Zones.of((0.9 * ends / ends[-1] - 0.45).reshape(count, 2))


def mirrored(zones):
    right = 0.5 * (zones.table + 0.46)
    return sie.Zones.of(
        np.concatenate((-right[::-1, ::-1], [[-0.004, 0.004]], right)), symmetric=True
    )


def equation(kernel):
    forcing = sie.Forcing(lambda x: np.sin(9 * x), lambda x: -np.cos(9 * x) / 9)
    return sie.Equation(kernel, forcing, (sie.Total(0.3), sie.EqualPotential()))


def systems(kernel, zones):
    """(system with an assembled matrix, system with fast sums), with the same modes."""
    problem, none = equation(kernel), ForcingJumps.none()
    m = modes.coupled(zones, kernel, 1e-13, 0)
    g = modes.sample(problem.forcing, zones, none, np.full(len(zones), 16), 1e-13, 512).coefficients
    return System(problem, zones, m, g, none), IterativeSystem(problem, zones, m, g, none)


def unknowns(layout, rng):
    """Random unknowns: coefficients decay, and the zones' loads vary over three decades."""
    table = rng.uniform(-1, 1, (len(layout.m), int(layout.m.max()) + 1)) * 0.7 ** np.arange(
        int(layout.m.max()) + 1
    )
    return layout.flat(table * 10 ** rng.uniform(-3, 0, len(layout.m))[:, None])


@pytest.mark.parametrize(("kernel", "symmetric"), diagonal(KERNELS, [False, True]))
def test_rows_and_levels_are_those_of_the_matrix(kernel, symmetric):
    kernel = KERNELS[kernel]
    rng = np.random.default_rng(3)
    zones = scattered(40, rng)
    direct, fast = systems(kernel, mirrored(zones) if symmetric else zones)
    symmetry = MirrorSymmetry.of(direct.zones, direct.layout)
    y = unknowns(direct.layout, rng)
    y = y if symmetry.keep is None else symmetry.unfold(y[symmetry.keep])
    matrix, _ = direct.equation_rows()
    rounding = 1e-14 * (np.abs(matrix) @ np.abs(y))
    assert np.all(np.abs(fast.applied(y)[0] - matrix @ y) <= rounding + 1e-15)
    levels, constants = direct.levels()
    rounding = 1e-14 * (np.abs(levels) @ np.abs(y)).max()
    assert np.abs(fast.level_changes(y) - levels @ y).max() <= rounding
    assert fast.level_constants == pytest.approx(constants, abs=1e-15)


def test_a_far_zone_left_out_is_detected(monkeypatch):
    """If the moments of one zone are left out, the comparison of the test above fails."""
    rng = np.random.default_rng(3)
    direct, fast = systems(KERNELS["period"], scattered(40, rng))
    y = unknowns(direct.layout, rng)
    original = Nested.upward
    monkeypatch.setattr(
        Nested,
        "upward",
        lambda self, leaves: original(self, leaves * (np.arange(len(leaves)) != 20)[:, None]),
    )
    matrix, _ = direct.equation_rows()
    assert np.abs(fast.applied(y)[0] - matrix @ y).max() > 1e-6


@pytest.mark.parametrize("kernel", KERNELS.values(), ids=KERNELS)
def test_every_pair_of_zones_is_counted_once(kernel):
    """The far pairs of nodes and the near pairs of zones together contain each pair of a target
    and a source once for each image. Nodes of a far pair are well separated.
    """
    zones = scattered(60, np.random.default_rng(5))
    tree = Tree.over(zones.a, zones.b)
    first, last = np.searchsorted(zones.a, tree.lo), np.searchsorted(zones.b, tree.hi)
    far, near = interactions(tree, tree, kernel.poles)
    met = np.zeros((len(kernel.poles), len(zones), len(zones)), dtype=int)
    for t, s, shift in zip(far.target, far.source, far.shift, strict=True):
        met[kernel.poles.index(shift), first[t] : last[t] + 1, first[s] : last[s] + 1] += 1
        gap = max(tree.lo[t] - tree.hi[s] - shift, tree.lo[s] + shift - tree.hi[t])
        assert gap >= SEPARATION * max(tree.half[t], tree.half[s])
    for t, s, shift in zip(near.target, near.source, near.shift, strict=True):
        met[kernel.poles.index(shift), t, s] += 1
    assert np.all(met == 1)


@pytest.mark.parametrize("count", [1, 2, 50])
@pytest.mark.parametrize("kernel", KERNELS.values(), ids=KERNELS)
def test_fields_anywhere_are_those_summed_zone_by_zone(kernel, count):
    rng = np.random.default_rng(7)
    zones = scattered(count, rng, decades=3.0)
    table = rng.uniform(-1, 1, (count, 12)) * 0.6 ** np.arange(12)
    table[:, 0], table[:, 1] = (
        -table[:, 2::2].sum(axis=1),
        -table[:, 3::2].sum(axis=1),
    )  # bounded ends
    density = sie.Density(zones, kernel, table, ForcingJumps.none(), np.zeros(0))
    treecode = Treecode(density)
    t = rng.uniform(-1, 1, (count, 4))
    x = np.concatenate(
        ((zones.middle[:, None] + zones.half[:, None] * t).ravel(), rng.uniform(-0.5, 0.5, 400))
    )
    if kernel.period is None:
        x = np.concatenate((x, [-40.0, -1.7, -0.6, 0.7, 1.19, 90.0]))
    assert treecode.transform(x) == pytest.approx(density.transform(x), abs=2e-13)
    assert treecode.potential(x) == pytest.approx(density.potential(x), abs=2e-14)


def test_half_a_period_from_the_middle_fields_do_not_depend_on_round_off():
    """Half a period from the middle of the zones, round-off decides whether a point is moved by a
    period to the other side. The kernel's regular part must be included on both sides.
    """
    for seed in range(20):
        zones = scattered(9, np.random.default_rng(seed))
        density = sie.Density(
            zones,
            KERNELS["period"],
            np.tile([0.5, 0.0, -0.5], (9, 1)),
            ForcingJumps.none(),
            np.zeros(0),
        )
        opposite = 0.5 * (zones.a[0] + zones.b[-1]) + 0.5 * np.array([-1.0, 1.0])
        x = (opposite[:, None] + 1e-16 * np.arange(-8, 9)).ravel()
        beside = opposite[0] + 1e-13
        transform, potential = float(density.transform(beside)), float(density.potential(beside))
        assert not density.has_treecode
        assert density.treecode.transform(x) == pytest.approx(transform, abs=1e-11)
        assert density.treecode.potential(x) == pytest.approx(potential, abs=1e-12)


def test_once_series_are_computed_single_points_use_them_too():
    zones = scattered(20, np.random.default_rng(3))
    density = sie.Density(
        zones, sie.cauchy(), np.tile([0.5, 0.0, -0.5], (20, 1)), ForcingJumps.none(), np.zeros(0)
    )
    before = density.transform(0.3)
    assert not density.has_treecode
    density.transform(np.linspace(-1.0, 1.0, 30_000))
    assert density.has_treecode
    assert (
        density.transform(0.3)
        == density.treecode.transform(np.array([0.3]))[0]
        == pytest.approx(before, rel=1e-12)
    )


def test_a_density_with_series_is_freed_without_the_garbage_collector():
    zones = scattered(20, np.random.default_rng(3))
    density = sie.Density(
        zones, sie.cauchy(), np.tile([0.5, 0.0, -0.5], (20, 1)), ForcingJumps.none(), np.zeros(0)
    )
    density.transform(np.linspace(-1.0, 1.0, 30_000))
    assert density.has_treecode
    held = weakref.ref(density)
    gc.disable()
    try:
        del density
        assert held() is None
    finally:
        gc.enable()


@pytest.mark.parametrize("kernel", KERNELS.values(), ids=KERNELS)
def test_few_zones_are_near_to_any_point_beside_a_cluster(kernel):
    """A hundred equal zones lie beside a gap much wider than all of them together. The cells in
    the gap are about as long as their distance from the zones, so few zones are near to a cell.
    """
    first = 1e-5 * np.arange(100)
    density = sie.Density(
        sie.Zones.of(np.column_stack((first, first + 5e-6))),
        kernel,
        np.tile([0.5, 0.0, -0.5], (100, 1)),
        ForcingJumps.none(),
        np.zeros(0),
    )
    treecode = Treecode(density)
    ends = treecode.ends
    assert np.diff(treecode.start).max() <= 5
    assert np.all(np.diff(ends) > 0) and np.all(np.isin(density.zones.table, ends))
    x = np.concatenate(
        (np.geomspace(1e-9, 0.2, 40) + density.zones.b[-1], -np.geomspace(1e-9, 0.2, 40))
    )
    assert treecode.transform(x) == pytest.approx(density.transform(x), rel=1e-13, abs=2e-13)


def test_the_number_of_terms_is_proportional_to_the_number_of_zones():
    """The zones are random, from one distribution. Four times as many zones need four times as
    many terms, up to the scatter of the distances.
    """
    sizes = []
    for count in (250, 1000, 4000):
        zones = scattered(count, np.random.default_rng(11), decades=1.0)
        m = np.full(len(zones), 8)
        system = System(
            equation(KERNELS["period"]), zones, m, np.zeros((count, 9)), ForcingJumps.none()
        )
        sizes.append(ZoneSums(zones, KERNELS["period"], system.layout).size)
    assert sizes[1] < 4.4 * sizes[0] and sizes[2] < 4.4 * sizes[1]
    assert sizes[2] < 0.1 * 9 * 8 * 3 * 4000**2  # a tenth of the terms of the matrix


class TestCoarseInverse:
    """Inverse of the matrix of logarithms that couples the loads of the zones."""

    @pytest.fixture
    def matrix(self):
        rng = np.random.default_rng(13)
        zones = scattered(500, rng, decades=2.0)

        def entries(i, j):
            distance = np.where(i == j, 1.0, np.abs(zones.middle[i] - zones.middle[j]))
            return np.where(i == j, np.log(zones.half[j] / 2), np.log(distance)) - 2.0

        return entries

    def test_undoes_the_matrix_to_its_tolerance(self, matrix):
        b = np.random.default_rng(0).standard_normal(500)
        every = np.arange(500)
        full = matrix(every[:, None], every)
        for tolerance in (1e-2, 1e-5, 1e-8):
            x = Inverse(matrix, 500, tolerance)(b)
            exact = np.linalg.solve(full, b)
            assert np.linalg.norm(x - exact) < 10 * tolerance * np.linalg.norm(exact)

    def test_blocks_off_the_diagonal_are_of_low_rank(self, matrix):
        # Two blocks are treated together: they are on both sides of the diagonal. The last row of
        # the first block and the last column of the second one do not count.
        rows = np.arange(500).reshape(2, 250)
        real = np.ones((2, 250), dtype=bool)
        real[0, -1] = False
        blocks = matrix(rows[:, :, None], rows[::-1, None, :])
        blocks[0, -1] = blocks[1, :, -1] = 0.0
        ranks = []
        for tolerance in (1e-3, 1e-6, 1e-9):
            u, v = cross_approximation(matrix, (rows, real), (rows[::-1], real[::-1]), tolerance)
            for block, one, other in zip(blocks, u, v, strict=True):
                wrong = np.linalg.norm(one @ other.T - block)
                assert wrong < 10 * tolerance * np.linalg.norm(block)
            ranks.append(u.shape[2])
        assert ranks == sorted(ranks) and ranks[-1] < 40

    @pytest.mark.parametrize("count", [1, 2, 63, 64, 65, 127, 131, 257])
    def test_rows_of_any_number_are_cut_into_equal_blocks(self, matrix, count):
        b = np.random.default_rng(1).standard_normal(count)
        x = Inverse(matrix, count, 1e-12)(b)
        full = matrix(np.arange(count)[:, None], np.arange(count))
        assert np.linalg.norm(full @ x - b) < 1e-9 * np.linalg.norm(full) * np.linalg.norm(x)

    def test_serves_moved_zones_until_one_is_far_narrower(self):
        zones, kernel = scattered(40, np.random.default_rng(3)), KERNELS["period"]
        coarse = CoarseOperator(zones, systems(kernel, zones)[1])
        for part, serves in ((0.8, True), (1e-3, False)):
            half = zones.half * np.where(np.arange(40) == 20, part, 1.0)
            moved = sie.Zones.of(np.column_stack((zones.middle - half, zones.middle + half)))
            assert coarse.serves(systems(kernel, moved)[1]) == serves


class TestGmres:
    def test_solves_to_its_tolerance(self):
        rng = np.random.default_rng(17)
        a = np.eye(80) + 0.3 * rng.standard_normal((80, 80)) / np.sqrt(80)
        b = rng.standard_normal(80)
        for tolerance in (1e-3, 1e-12):
            found = gmres(lambda v: a @ v, b, tolerance)
            assert np.linalg.norm(a @ found.x - b) <= 1.01 * tolerance + 1e-13
            assert found.residual <= tolerance

    def test_takes_as_many_steps_as_there_are_distinct_eigenvalues(self):
        factors = np.repeat([1.0, 1.5, 0.5], 20)
        found = gmres(lambda v: factors * v, np.ones(60), 1e-12)
        assert found.steps == 3 and found.x == pytest.approx(1 / factors, rel=1e-12)

    def test_a_zero_right_side_takes_no_step(self):
        found = gmres(lambda v: v, np.zeros(5), 1e-12)
        assert found.steps == 0 and not found.x.any()


def test_far_fields_use_the_part_of_the_ends_below_the_last_digit():
    """A tree gets the parts `rest` of the ends below their last digit separately, since the width
    of a narrow zone is the difference of two such ends. The fields must be those of a tree over
    the sums of ends and parts. Here the parts are 1e-4 of the widths, so that these sums have
    enough digits.
    """
    rng = np.random.default_rng(3)
    zones = scattered(80, rng)
    rest = 1e-4 * rng.uniform(-1, 1, (2, 80)) * (zones.b - zones.a)
    moments = rng.normal(size=(80, TERMS))
    told, there = (
        Nested(Tree.over(zones.a, zones.b, rest)),
        Nested(Tree.over(zones.a + rest[0], zones.b + rest[1])),
    )
    for one, other in zip(
        FarSum(told, told, sie.cauchy())(moments)[:2],
        FarSum(there, there, sie.cauchy())(moments)[:2],
        strict=True,
    ):
        assert np.abs(one - other).max() <= 1e-11 * np.abs(other).max()


def test_stored_and_recomputed_matrices_of_the_tree_give_the_same_series():
    rng = np.random.default_rng(4)
    zones = scattered(70, rng)
    kept, made = (Nested(Tree.over(zones.a, zones.b), kept=kept) for kept in (True, False))
    moments = rng.normal(size=(70, TERMS // 2))
    assert np.allclose(kept.upward(moments), made.upward(moments), rtol=0, atol=1e-12)
    series, middle = rng.normal(size=(TERMS // 2, len(kept.tree))), rng.normal(size=len(kept.tree))
    for one, other in zip(
        *(nested.downward(series.copy(), middle.copy())[:2] for nested in (kept, made)), strict=True
    ):
        assert np.allclose(one, other, rtol=0, atol=1e-11)
