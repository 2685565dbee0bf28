"""Histories of the normal load and the tangential load."""

from collections.abc import Sequence

import numpy as np

from contact.errors import NotConverged, SceneError
from contact.model.checks import positive
from contact.model.scene import Scene
from contact.slip.checks import friction_of, require_similar, tangential_load_of
from contact.slip.memory import Memory, Segment
from contact.slip.partial_slip import State, slip_of, solved_or_best
from contact.slip.result import Slip
from contact.solution.solution import Solution
from contact.solver import tolerance
from contact.sweeps.solve_many import solve_many


def load_history(
    scene: Scene, friction: float, history: Sequence[tuple[float, float]], tol: float = 1e-8
) -> list[Slip]:
    """Shear, slip and dissipated energy after each segment of a history of the two loads.
    The two loads are the normal and the tangential load.

    The segments are straight in (P, Q) and begin at (0, 0). No step is taken within them: the
    result of a segment is exact, see `contact.slip.memory`.

    Parameters
    ----------
    scene : Scene
        The scene. The value of its own control is not used.
    friction : float
        Coefficient of friction [1], above 0.
    history : sequence of (P, Q)
        Load and tangential load at the end of each segment [N/m], P > 0, |Q| <= friction P.
    tol : float
        Largest stated error of each contact. A shear is a sum of pressures, so `Slip.error` may
        be a few times larger.

    Returns
    -------
    list of Slip
        One for each segment; `dissipated` is the energy that slip lost in it.

    Raises
    ------
    SceneError
        If a value is bad, or the shear does not follow from pressures; see `contact.partial_slip`.
    OutOfRange, NotConverged
        As `contact.solve`.

    Examples
    --------
    Where both loads grow in one ratio nothing slips. A cycle of Q at a constant load loses energy.

    >>> import contact
    >>> scene = contact.Scene(contact.Parabola(1.0), 2e9, contact.Isolated(), load=1.0)
    >>> cycle = [(1e4, 2e3), (1e4, -2e3), (1e4, 2e3), (1e4, -2e3)]
    >>> slips = contact.load_history(scene, 0.5, cycle)
    >>> [float(f"{slip.dissipated:.3g}") for slip in slips]
    [0.0, 0.000251, 0.000107, 0.000107]
    """
    if not isinstance(scene, Scene):
        raise SceneError.of("scene", scene, "a contact.Scene")
    require_similar(scene)
    mu, tol = friction_of(friction), tolerance(tol)
    points = _checked(history, mu)
    memory = Memory(mu)
    states = [State(mu, shear, memory.go_to(load, shear)) for load, shear in points]
    loads = sorted({load for state in states for load in _loads(state.segment)} - {0.0})
    contacts = _contacts(scene, loads, tol)
    return [slip_of(contacts, state, tol) for state in states]


def _contacts(scene: Scene, loads: list[float], tol: float) -> dict[float, Solution]:
    """Solution at each load; if the tolerance is missed, the best solution that was reached."""
    try:
        return dict(zip(loads, solve_many(scene, loads, "load", tol), strict=True))
    except NotConverged:
        return {load: solved_or_best(scene.under("load", load), tol) for load in loads}


def _checked(history: object, friction: float) -> list[tuple[float, float]]:
    """The points of a history; SceneError names the first one that is not valid."""
    allowed = "a list of at least one pair (load, tangential load)"
    if isinstance(history, str) or not isinstance(history, Sequence | np.ndarray):
        raise SceneError.of("history", history, allowed)
    if len(history) == 0 or any(np.shape(point) != (2,) for point in history):
        raise SceneError.of("history", history, allowed)
    out = []
    for place, (load, shear) in enumerate(history):
        try:
            load = positive("load", load)
            out.append((load, tangential_load_of(shear, friction, load)))
        except SceneError as error:
            raise SceneError(
                f"history[{place}]: {error}", error.field, error.value, error.allowed
            ) from error
    return out


def _loads(segment: Segment) -> set[float]:
    """The normal loads at which the contact must be solved to give the slip of a segment."""
    steps = {load for step in segment.steps for load in (*step.stick, *step.load)}
    return {layer.top for layer in segment.layers} | steps | {segment.stick}
