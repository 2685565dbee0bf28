"""What a scene needs: every part of the machinery, used or left out, with the reason, its size and
the time it took.
"""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from contact.errors import SceneError
from contact.model.controls import Quantity
from contact.model.scene import Scene


@dataclass
class Part:
    """One part: its name, whether it ran, why or why not, its size in words, and its seconds (None
    if it has not run).
    """

    name: str
    used: bool
    reason: str
    detail: str = ""
    seconds: float | None = None


@dataclass
class Plan:
    """The parts in order, counts of work done, what was tried on the way and why it was left, and
    the seconds that it all took.

    `plan["zone ends"]` is one part: name, used, reason, detail, seconds.

    Parameters
    ----------
    parts : list
        What may run, used or left out, each with the reason.
    counts : dict
        Solves, modes and kernel evaluations.
    tried : list of str
        What was tried and why it was left.
    seconds : float or None
        Time of all; None if it has not run.

    Examples
    --------
    >>> import contact
    >>> scene = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), mean_pressure=1e6)
    >>> solution = contact.solve(scene)
    >>> solution.plan["coarse search"].used, solution.plan.tried
    (False, [])
    """

    parts: list[Part] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=dict)
    tried: list[str] = field(default_factory=list)
    seconds: float | None = None
    _within: list[float] = field(default_factory=list, repr=False)

    def __getitem__(self, name: str) -> Part:
        for part in self.parts:
            if part.name == name:
                return part
        raise KeyError(name)

    @contextmanager
    def timed(self, name: str) -> Iterator[Part]:
        """Add the time of a block to a part, less that of the parts within it: seconds of parts add
        up.
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
        """Share of the time that a part took; None if it has not run, or has no time of its own."""
        return None if part.seconds is None or not self.seconds else part.seconds / self.seconds

    def to_dict(self) -> dict[str, Any]:
        parts = [{**vars(part), "share": self.share(part)} for part in self.parts]
        return {
            "parts": parts,
            "counts": dict(self.counts),
            "tried": list(self.tried),
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        lines = [
            f"{'used' if p.used else 'left out':9}{p.name:22}{p.reason} {p.detail}"
            for p in self.parts
        ]
        lines += [f"{'tried':9}{left}" for left in self.tried]
        return "\n".join(line.rstrip() for line in lines)


def plan(scene: Scene) -> Plan:
    """What solving the scene would run, without running it.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    Plan

    Raises
    ------
    SceneError
        If it is no scene.

    Examples
    --------
    >>> import contact
    >>> scene = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), mean_pressure=1e6)
    >>> part = contact.plan(scene)["periodic kernel"]
    >>> part.used, part.reason
    (True, 'the whole period repeats')
    """
    if not isinstance(scene, Scene):
        raise SceneError.of("scene", scene, "a contact.Scene")
    profile, model = scene.profile, scene.interaction
    given, single = scene.held(Quantity.HALF_WIDTH) is not None, starts_from_one_zone(scene)
    kinks = len(profile.kinks) + len(profile.algebraic_points)
    why_no_search = "zones are given" if given else "one symmetric asperity"
    only_images = f"{model.name}: nothing repeats beyond its images"
    return Plan(
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
                "the whole period repeats",
                only_images,
            ),
            _inverse(scene),
            _part(
                "localization term",
                bool(model.strip),
                "nominal pressure beyond the strip",
                f"{model.name} has none",
            ),
            _part(
                "isolated reference",
                model.follows_isolated,
                "the first-order closure needs the isolated load",
                "no closure that needs it",
            ),
            _part("kinks", kinks > 0, f"{kinks} declared", "none declared"),
            _part("zone ends", not given, "unknown: Newton", "half width given"),
            Part("slits", False, "no zones beside narrow gaps known"),
            Part("fast sums", False, "few zones: sums are direct"),
            Part("certificate", True, "always"),
            Part("fields", False, "computed when asked"),
        ]
    )


def _part(name: str, used: bool, why: str, why_not: str) -> Part:
    return Part(name, used, why if used else why_not)


def _inverse(scene: Scene) -> Part:
    """What the model's operator offers beyond its kernel: full contact, and nearly full contact by
    its gaps.
    """
    operator, name = (
        scene.operator,
        scene.interaction.name if scene.operator.is_own else scene.substrate.name,
    )
    if not operator.is_periodic:
        return Part("inverse operator", False, f"{scene.interaction.name} has no full contact")
    if operator.has_inverse:
        body = "half-plane" if operator.is_half_plane else f"{name} has a symbol"
        return Part(
            "inverse operator", True, f"{body}: full contact, and gaps where contact is nearly full"
        )
    return Part(
        "inverse operator", False, f"{name} declares no symbol: by its zones alone, no full contact"
    )


def _branch(scene: Scene) -> Part:
    """Which of several equilibria: filled in as it is followed."""
    if not scene.law.equilibria.several:
        return Part(
            "branch",
            False,
            f"{scene.law.name}: one equilibrium"
            if scene.law.equilibria.unique
            else f"{scene.law.name}: followed by none",
        )
    if scene.held(Quantity.HALF_WIDTH) is not None:
        return Part("branch", False, "half width given")
    return Part("branch", True, f"{scene.law.name}: several equilibria")


def _symmetry(scene: Scene) -> Part:
    if scene.turned:
        return Part("symmetry", False, "the body is turned")
    return _part(
        "symmetry", bool(scene.profile.symmetric), "profile symmetric", "profile not symmetric"
    )


def _tilt(scene: Scene) -> Part:
    """The tilt of the body: none, a part of the profile, or one more unknown."""
    if not scene.turned:
        return Part(
            "tilt",
            False,
            "none given" if scene.moment is None else "no moment turns a symmetric body",
        )
    return Part(
        "tilt",
        True,
        "given: a part of the profile"
        if scene.moment is None
        else "unknown: found with the moment",
    )


def starts_from_one_zone(scene: Scene) -> bool:
    """Whether the first guess is one zone about the tip of a symmetric asperity, as wide as on a
    half-plane.
    """
    summits = scene.profile.summits
    if not scene.operator.is_plain:
        return False
    return not scene.turned and bool(
        scene.profile.symmetric and summits is not None and len(summits) == 1 and summits[0] == 0.0
    )
