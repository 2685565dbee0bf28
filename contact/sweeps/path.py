"""`contact.path`: one scene along a list of values of its control, with all events between them."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.model.checks import finite_array
from contact.model.scene import Scene
from contact.search.topology.loop import Progress
from contact.solver import tolerance
from contact.sweeps.adhesive import VALUES, adhesive_path
from contact.sweeps.paths import Path, growing_path
from sie import Array


def refuse_unloading(scene: Scene, loads: Array, blamed: tuple[str, Any, str]) -> None:
    """Raise SceneError if the loads decrease under a law that cannot unload in the same scene.

    After plastic contact, unloading begins in a scene with the profile `Solution.worn()`.

    blamed: name and value of the wrong parameter, and what the parameter must be.
    """
    if scene.law.routes.first is not None and np.any(np.diff(loads) < 0):
        name, value, allowed = blamed
        why = (
            f"under {scene.law.name}: for unloading, solve the elastic contact of the profile "
            "Solution.worn()"
        )
        raise SceneError.of(name, value, f"{allowed} {why}")


def path(
    scene: Scene,
    values: ArrayLike,
    tol: float = 1e-8,
    progress: Progress | None = None,
    control: str | None = None,
    stiffness: float | None = None,
) -> Path:
    """Solve a scene along values of a control and locate all events between them.

    Each value replaces the scene's own control in turn; a tilt or moment stays. Without adhesion,
    contact grows with the load and the values are loads. With adhesion the result depends on the
    order: values may rise and fall, and each jump is located, with the energy it dissipates
    (`contact.AdhesivePath`, docs/adhesion.md).

    Parameters
    ----------
    scene : Scene
        The scene. The value of its own control is not used.
    values : array_like
        Values of the control, shape (n,), in any order: loads [N/m] (per period for periodic
        scenes), mean pressures [Pa] or approaches [m]. Without adhesion they are positive. With
        adhesion, a path whose first value is negative begins with the surfaces apart; any other
        begins with the contact reached from first touch by raising the control.
    tol : float
        Largest stated error of each solution.
    progress : callable or None
        Called with (stage, done, total or None).
    control : str or None
        "load", "mean_pressure" or, with adhesion, "approach"; None: the load, or the approach where
        a stiffness is given.
    stiffness : float or None
        Stiffness of a spring between the body and the machine [N/m^2] (per unit thickness, and per
        period for periodic scenes). The approaches are then those of the spring's far end; the
        contact's own approach is smaller by load/stiffness. None: a rigid machine.

    Returns
    -------
    Path
        `contact.AdhesivePath` under adhesion.

    Raises
    ------
    SceneError, OutOfRange, NotConverged
        As `contact.solve`. If some loads miss the tolerance, NotConverged names them after all were
        tried, and its `best` is the path through the others. SceneError also for a law whose path
        cannot be followed, or for a control that the path does not accept.

    Examples
    --------
    >>> import contact
    >>> wave = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), load=1.0)
    >>> found = contact.path(wave, [1e3, 2e3, 4e3])
    >>> [event.kind for event in found.events], len(found.solutions)
    (['full'], 3)

    With a softer spring, pull-off comes at a larger approach.

    >>> datum, adhesive = contact.Isolated(datum=1e-2), contact.JKR(0.05)
    >>> rubber = contact.Scene(contact.Parabola(1e-3), 1e6, datum, law=adhesive, load=0.0)
    >>> ends = [contact.path(rubber, [0.0, -3e-3], stiffness=k).events[-1] for k in (1e3, 1e6)]
    >>> [event.kind for event in ends], ends[0].approach > ends[1].approach
    (['pull-off', 'pull-off'], True)
    """
    if not isinstance(scene, Scene):
        raise SceneError.of("scene", scene, "a contact.Scene")
    tol = tolerance(tol)
    if control not in (None, *VALUES):
        raise SceneError.of("control", control, f"None, or one of {', '.join(VALUES)}")
    if stiffness is not None and control not in (None, "approach"):
        raise SceneError.of(
            "stiffness",
            stiffness,
            f"left out under the control {control}: with a spring, the values are approaches of "
            "the spring's far end",
        )
    name = control or ("load" if stiffness is None else "approach")
    if scene.law.equilibria.several:
        return adhesive_path(scene, values, tol, progress, name, stiffness)
    if not scene.law.equilibria.unique:
        raise SceneError.of(
            "law",
            scene.law.name,
            "a law with convex = True, or with another law as `bare`: no path is computed under "
            "other laws",
        )
    if name == "approach":
        what, given = ("control", control) if stiffness is None else ("stiffness", stiffness)
        raise SceneError.of(
            what,
            given,
            f"left out: under {scene.law.name} the values of a path are loads or mean pressures, "
            "and a spring has no effect",
        )
    loads = finite_array("values", values)
    if np.any(loads <= 0):
        first = int(np.argmax(loads <= 0))
        raise SceneError.of(
            "values", loads, f"positive {VALUES[name]} (element {first} is {loads[first]:.6g})"
        )
    refuse_unloading(scene, loads, ("values", loads, "rising"))
    if name == "mean_pressure":
        if scene.profile.period is None:
            raise SceneError.of(
                "control", control, "load: without a period there is no mean pressure"
            )
        loads = loads * scene.profile.period
    return growing_path(scene, loads, tol, progress)
