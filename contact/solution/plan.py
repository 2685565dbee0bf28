"""The plan of a solve: its parts, used or left out, and its choices, each with the reason.

A part has its size and its time. A choice is a `Decision`, stored under the question that it
answers.
"""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from contact.errors import SceneError
from contact.model.controls import Quantity
from contact.model.scene import Scene
from contact.solution.decision import Decision


@dataclass
class Part:
    """One part of a solve: its name, whether and why it ran, its size in words, and its time.

    seconds: None if the part has not run.
    """

    name: str
    used: bool
    reason: str
    detail: str = ""
    seconds: float | None = None


@dataclass
class Plan:
    """The parts that a solve runs and the choices that it makes, each with the reason.

    `plan["zone ends"]` is one part: name, used, reason, detail, seconds.
    `plan.decisions["unknowns"]` is one choice: way, because, measured, threshold.

    Parameters
    ----------
    parts : list
        All parts that may run, used or left out, each with the reason.
    counts : dict
        Numbers of solves, modes and kernel evaluations.
    tried : list of str
        Strategies that did not lead to the solution, each with the reason.
    seconds : float or None
        Time of the whole solve; None if it has not run.
    decisions : dict
        Each choice between ways (`way, because, measured, threshold`), under its question:
        "solver", "first guess", "unknowns", "full contact", "control", "branch".

    Examples
    --------
    >>> import contact
    >>> wave = contact.Sinusoid(1e-6, 1e-4)
    >>> scene = contact.Scene(wave, 1e9, contact.Periodic(), mean_pressure=1e6)
    >>> solution = contact.solve(scene)
    >>> solution.plan["coarse search"].used, solution.plan.tried
    (False, [])
    >>> print(solution.plan.decisions["solver"])
    closed form, since one symmetric zone of a half-plane needs no coupled system
    """

    parts: list[Part] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=dict)
    tried: list[str] = field(default_factory=list)
    seconds: float | None = None
    decisions: dict[str, Decision] = field(default_factory=dict)
    _within: list[float] = field(default_factory=list, repr=False)

    def __getitem__(self, name: str) -> Part:
        for part in self.parts:
            if part.name == name:
                return part
        raise KeyError(name)

    def decide(
        self,
        question: str,
        way: str,
        because: str,
        measured: float | None = None,
        threshold: float | None = None,
    ) -> None:
        """Store the answer to a question as a `Decision`; it replaces an earlier answer."""
        self.decisions[question] = Decision(way, because, measured, threshold)

    @contextmanager
    def timed(self, name: str) -> Iterator[Part]:
        """Add the running time of a block to a part of the plan.
        The time of parts that are timed inside the block is left out.
        """
        part = self[name]
        start = time.perf_counter()
        self._within.append(0.0)
        try:
            yield part
        finally:
            took = time.perf_counter() - start
            part.seconds = (part.seconds or 0.0) + took - self._within.pop()
            if self._within:
                self._within[-1] += took

    def share(self, part: Part) -> float | None:
        """Fraction of the total time that a part took; None if its time was not measured."""
        return None if part.seconds is None or not self.seconds else part.seconds / self.seconds

    def to_dict(self) -> dict[str, Any]:
        parts = [{**vars(part), "share": self.share(part)} for part in self.parts]
        return {
            "parts": parts,
            "counts": dict(self.counts),
            "tried": list(self.tried),
            "seconds": self.seconds,
            "decisions": {
                question: {**vars(decision), "text": str(decision)}
                for question, decision in self.decisions.items()
            },
        }

    def __str__(self) -> str:
        lines = [
            f"{'used' if p.used else 'left out':9}{p.name:22}"
            f"{'; '.join(filter(None, (p.reason, p.detail)))}"
            for p in self.parts
        ]
        lines += [
            f"{'decided':9}{question:22}{decision}" for question, decision in self.decisions.items()
        ]
        lines += [f"{'tried':9}{failure}" for failure in self.tried]
        return "\n".join(line.rstrip() for line in lines)


def plan(scene: Scene) -> Plan:
    """Return the parts and choices of solving the scene, without solving it.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    Plan

    Raises
    ------
    SceneError
        If the argument is not a scene.

    Examples
    --------
    >>> import contact
    >>> wave = contact.Sinusoid(1e-6, 1e-4)
    >>> scene = contact.Scene(wave, 1e9, contact.Periodic(), mean_pressure=1e6)
    >>> part = contact.plan(scene)["periodic kernel"]
    >>> part.used, part.reason
    (True, 'the contact repeats with the period')
    """
    if not isinstance(scene, Scene):
        raise SceneError.of("scene", scene, "a contact.Scene")
    profile, model = scene.profile, scene.interaction
    given, single = scene.held(Quantity.HALF_WIDTH) is not None, starts_from_one_zone(scene)
    kinks = len(profile.kinks) + len(profile.algebraic_points)
    why_no_search = "zones are given" if given else "one symmetric asperity"
    beyond = " beyond the copies of the strip" if model.needs_period else ""
    only_images = f"{model.name}: the contact does not repeat{beyond}"
    made = Plan(
        [
            _part(
                "numerical slope",
                profile.slope_is_derived,
                "the profile gives no slope",
                "the profile gives its slope",
            ),
            _part("coarse search", not (given or single), "number of zones unknown", why_no_search),
            _branch(scene),
            _symmetry(scene),
            _tilt(scene),
            _part(
                "periodic kernel",
                scene.operator.is_periodic,
                "the contact repeats with the period",
                only_images,
            ),
            _inverse(scene),
            _part(
                "localization term",
                bool(model.strip),
                "the surface outside the strip is approximated",
                f"{model.name} has no strip",
            ),
            _part(
                "isolated reference",
                model.follows_isolated,
                "the first-order closure needs the load of the isolated contact",
                "no closure needs it",
            ),
            _part("kinks", kinks > 0, f"{kinks} declared", "none declared"),
            _part("zone ends", not given, "unknown: Newton's method", "half width given"),
            Part("slits", False, "no zones next to narrow gaps are known"),
            Part("fast sums", False, "few zones: the sums are computed directly"),
            Part("certificate", True, "always"),
            Part("fields", False, "computed when asked"),
        ]
    )
    module = scene.law.routes.module
    if module is not None:
        made.decide("first guess", "that of the module", f"{scene.law.name} is solved by {module}")
    elif given:
        made.decide("first guess", "the given zone", "the half width is given")
    elif single:
        made.decide("first guess", "one zone", "the profile is one symmetric asperity")
    else:
        made.decide("first guess", "a grid", "the number of zones is unknown")
    if made["branch"].used:
        made.decide("branch", "one branch is followed", f"{made['branch'].reason}")
    return made


def _part(name: str, used: bool, why: str, why_not: str) -> Part:
    """One part of the plan, with the reason why it is used or not used."""
    return Part(name, used, why if used else why_not)


def _inverse(scene: Scene) -> Part:
    """The part "inverse operator" of the plan: it serves full and nearly full contact."""
    operator, name = (
        scene.operator,
        scene.interaction.name if scene.operator.is_own else scene.substrate.name,
    )
    if not operator.is_periodic:
        return Part("inverse operator", False, f"{scene.interaction.name} has no full contact")
    if operator.has_inverse:
        body = "half-plane" if operator.is_half_plane else f"{name} has a symbol"
        return Part(
            "inverse operator",
            True,
            f"{body}: used in full contact, and for the gaps of nearly full contact",
        )
    return Part(
        "inverse operator",
        False,
        f"{name} declares no symbol: the zones are the unknowns, and full contact is refused",
    )


def _branch(scene: Scene) -> Part:
    """The part "branch" of the plan: with several equilibria, one branch of them is followed."""
    if not scene.law.equilibria.several:
        return Part(
            "branch",
            False,
            f"{scene.law.name}: one equilibrium"
            if scene.law.equilibria.unique
            else f"{scene.law.name}: no branch is followed",
        )
    if scene.held(Quantity.HALF_WIDTH) is not None:
        return Part("branch", False, "half width given")
    return Part("branch", True, f"{scene.law.name}: several equilibria")


def _symmetry(scene: Scene) -> Part:
    """The part of the plan that solves for one half of a symmetric contact."""
    if scene.turned:
        return Part("symmetry", False, "the body is turned")
    if scene.law.kappa:
        return Part("symmetry", False, "sliding with elastic mismatch has a direction")
    return _part(
        "symmetry", bool(scene.profile.symmetric), "profile symmetric", "profile not symmetric"
    )


def _tilt(scene: Scene) -> Part:
    """The part of the plan that turns the body, by a given tilt or by an unknown tilt."""
    if not scene.turned:
        return Part(
            "tilt",
            False,
            "none given"
            if scene.moment is None
            else "a zero moment does not turn a symmetric body",
        )
    return Part(
        "tilt",
        True,
        "given: added to the profile" if scene.moment is None else "unknown: found from the moment",
    )


def starts_from_one_zone(scene: Scene) -> bool:
    """Whether the first guess is one zone about x = 0, as wide as a contact on a half-plane.

    This holds for one symmetric asperity with its tip at x = 0.
    """
    summits = scene.profile.summits
    if not scene.operator.is_plain:
        return False
    return not scene.turned and bool(
        scene.profile.symmetric and summits is not None and len(summits) == 1 and summits[0] == 0.0
    )
