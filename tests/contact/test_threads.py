"""`one_blas_thread` limits BLAS to one thread, and afterwards restores the number of threads."""

import pytest
from threadpoolctl import ThreadpoolController, threadpool_limits

import contact
from contact.runtime import one_blas_thread


def threads():
    return {
        library["num_threads"] for library in ThreadpoolController().select(user_api="blas").info()
    }


@pytest.fixture
def three():
    with threadpool_limits(3, "blas"):
        if threads() != {3}:
            pytest.skip("this BLAS has not as many threads as are asked for")
        yield


def test_blas_has_one_thread_until_the_outermost_context_ends(three):
    with one_blas_thread():
        assert threads() == {1}
        with one_blas_thread(), pytest.raises(KeyError), one_blas_thread():
            raise KeyError
        assert threads() == {1}
    assert threads() == {3}


def test_adhesive_equilibria_are_followed_with_one_thread(three):
    seen = []

    class Wave(contact.Sinusoid):
        def height(self, x):
            seen.append(threads())
            return super().height(x)

    scene = contact.Scene(
        Wave(1e-6, 1e-4), 1e9, contact.Periodic(), law=contact.JKR(0.05), mean_pressure=1e6
    )
    solution = contact.solve(scene)
    assert {1} in seen
    del seen[:]
    assert solution.pull_off.load < 0.0
    assert seen and all(one == {1} for one in seen)
    assert threads() == {3}


def test_load_curves_use_one_thread_and_single_scenes_use_all(three):
    seen = []

    class Wave(contact.Sinusoid):
        symmetric = False

        def height(self, x):
            seen.append(threads())
            return super().height(x)

    scene = contact.Scene(Wave(1e-6, 1e-4), 1e9, contact.Periodic(), mean_pressure=1e6)
    contact.solve(scene)
    assert seen and all(one == {3} for one in seen)
    del seen[:]
    contact.solve_many(scene, [1e6, 2e6, 3e6])
    assert {1} in seen
    assert threads() == {3}
