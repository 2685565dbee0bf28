"""Profiles as users write them, with true and false declarations, against exact solutions.

    python -m contact.studies.own_profiles FIRST COUNT [--tol 1e-8] [--limit 60] [--out FILE.csv]

A scene has a shape with a known solution: an inverse-designed contact, a Fourier series in full
contact, or a closed form. The solver gets the shape as a user might write it: heights alone, with a
constant of up to 1e6 amplitudes, far from x = 0, or with a false declaration. A solution must be
within its stated error of the known one; a false declaration may be refused. Two families have no
known solution. Ripples on a parabola are solved from heights alone and from heights and slope; flat
tops are solved at a load and at the approach of that load. Both answers must agree.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import contact
from contact.reference import exact
from contact.reference.inverse import random_problem
from contact.studies.random_scenes import Drawn, main, unsound

Array = NDArray[np.float64]

# Pressures are compared at these angles, which stop short of the ends 0 and pi of a zone.
ANGLES = np.linspace(0.02, np.pi - 0.02, 160)


@dataclass(frozen=True, eq=False)
class HeightsOnly(contact.Profile):
    """A shape given by its heights alone, moved by `offset` and raised by `constant`."""

    shape: Any
    constant: float = 0.0
    offset: float = 0.0
    period: float | None = None

    def height(self, x: ArrayLike) -> Array:
        """The heights of the shape [m]."""
        return np.asarray(self.constant + self.shape.height(np.asarray(x) - self.offset))


@dataclass(frozen=True, eq=False)
class Sloped(HeightsOnly):
    """A shape given by heights and slopes; a factor other than 1 makes the slopes wrong."""

    factor: float = 1.0

    def slope(self, x: ArrayLike) -> Array:
        """The slopes of the shape, times the factor."""
        return np.asarray(self.factor * self.shape.slope(np.asarray(x) - self.offset))


@dataclass(frozen=True, eq=False)
class Phantom(Sloped):
    """A shape given by heights, slopes and a declared kink that it does not have."""

    kink: tuple[float, float] = (0.0, 0.0)

    @property
    def kinks(self) -> Array:
        """The declared kink, a table of one row (position, jump of the slope)."""
        return np.array([self.kink])


@dataclass(frozen=True, eq=False)
class Conjugate(Sloped):
    """A shape given by heights, slopes and conjugate H f'; a factor other than 1 is wrong."""

    conjugate: float = 1.0

    def slope_conjugate(self, x: ArrayLike) -> Array:
        """Conjugate H f' of the Fourier series, times the factor."""
        return self.conjugate * conjugate(self.shape, np.asarray(x) - self.offset)


@dataclass(frozen=True, eq=False)
class Even(Sloped):
    """A shape given by heights and slopes and declared symmetric, which may be false."""

    symmetric = True  # type: ignore[assignment]


def conjugate(series: contact.Fourier, x: Array) -> Array:
    """Conjugate H f' = sum kq (a_k cos kqx + b_k sin kqx) of a series f.

    The series is f = sum a_k cos kqx + b_k sin kqx.
    """
    cosine, sine = np.asarray(series.cosine, dtype=float), np.asarray(series.sine, dtype=float)
    k = np.arange(1, len(cosine) + 1)
    angle = 2 * np.pi / series.period * np.asarray(x)[..., None] * k
    wave = 2 * np.pi * k / series.period
    return np.asarray(np.cos(angle) @ (wave * cosine) + np.sin(angle) @ (wave * sine))


@dataclass(frozen=True)
class Known(Drawn):
    """A scene, and a judge that compares its solution with the known one."""

    judge: Callable[[contact.Solution, float], str] = field(default=lambda solution, tol: "")

    def fault(self, solution: contact.Solution, tol: float) -> str:
        """Return what is wrong with a solution; empty if nothing is."""
        return unsound(self.scene, solution, tol) or self.judge(solution, tol)


Judge = Callable[[contact.Solution, float], str]


def against(answer: Any, offset: float = 0.0, known_to: float = 1e-13) -> Judge:
    """Return a judge that compares with known zones and pressures, accurate to `known_to`."""

    def judge(solution: contact.Solution, tol: float) -> str:
        if solution.certificate.undecided:
            return ""
        if len(solution.zones) != len(answer.zones):
            return f"{len(solution.zones)} zones for {len(answer.zones)}"
        if len(answer.zones) == 0:
            return _against_full_twin(solution, answer, known_to)
        right = np.diff(answer.zones)[:, 0]
        period = solution.scene.period or np.inf
        # A zone at the border of the cell may come first or last: all cyclic orders are tried.
        zones = np.arange(len(right))

        def difference(order: Any) -> Array:
            found = solution.zones - offset - answer.zones[order]
            return found - (np.round(found / period) * period if np.isfinite(period) else 0.0)

        orders = [np.roll(zones, -turn) for turn in zones]
        order = min(orders, key=lambda order: float(np.abs(difference(order)).max()))
        # Round-off of the positions themselves does not count.
        spacing = 2 * np.spacing(np.abs(solution.zones).max() + abs(offset))
        ends = float(((np.abs(difference(order)) - spacing) / right[order, None]).max())
        t = np.cos(ANGLES)
        found = np.array([solution.pressure_at(t, int(k)) for k in zones])
        known = np.array([answer.pressure_at(t, int(k)) for k in order])
        pressure = float(np.abs(found - known).max() / np.abs(known).max())
        message = f"ends off by {ends:.1e}, pressure by {pressure:.1e}, stated {solution.error:.1e}"
        return message if max(ends, pressure) > solution.error + known_to else ""

    return judge


def _against_full_twin(solution: contact.Solution, twin: Any, known_to: float) -> str:
    """Return how the pressure of full contact differs from that of `twin`; else empty."""
    profile, period = solution.scene.profile, solution.scene.period
    assert period is not None
    # These positions do not fall on kinks, where pressures are infinite.
    x = profile.x0 + period * (np.arange(777) + 0.4142) / 777
    right = twin.pressure(x)
    error = float(np.abs(solution.pressure(x) - right).max() / np.abs(right).max())
    message = f"pressure off by {error:.1e}, stated {solution.error:.1e}"
    return message if error > solution.error + known_to else ""


def against_full(series: contact.Fourier, offset: float) -> Judge:
    """Return a judge that compares with full contact, p = mean p - (E*/2) H f'."""

    def judge(solution: contact.Solution, tol: float) -> str:
        if len(solution.zones):
            return f"{len(solution.zones)} zones for full contact"
        x = series.period * np.linspace(-0.5, 0.5, 777)
        assert solution.mean_pressure is not None
        right = solution.mean_pressure - 0.5 * solution.scene.E_star * conjugate(series, x)
        error = float(np.abs(solution.pressure(x + offset) - right).max() / np.abs(right).max())
        message = f"pressure off by {error:.1e}, stated {solution.error:.1e}"
        return message if error > solution.error + 1e-13 else ""

    return judge


def against_twin(twin: contact.Scene) -> Judge:
    """Return a judge that compares with the solution of another scene with the same answer.

    The other scene has true declarations, or another control.
    """

    def judge(solution: contact.Solution, tol: float) -> str:
        try:
            other = contact.solve(twin, tol=max(0.1 * tol, 1e-12))
        except contact.ContactError:
            return ""
        return against(other, known_to=other.error)(solution, tol)

    return judge


def _disguise(
    rng: np.random.Generator, shape: Any, period: float | None, length: float, span: float
) -> tuple[str, HeightsOnly]:
    """Return a shape as a user might write it: (name of the kind, profile)."""
    constant = float(rng.choice([0.0, span * 10 ** rng.uniform(-1, 6)]))
    away = length * (np.round(10 ** rng.uniform(0, 6)) + rng.uniform(-0.5, 0.5))
    offset = float(rng.choice([0.0, 0.0, away]))
    plain: dict[str, Any] = dict(shape=shape, constant=constant, offset=offset, period=period)
    off = float(rng.choice([-1, 1])) * 10 ** rng.uniform(-9, 0)
    at = offset + length * rng.uniform(-0.5, 0.5)
    kinked = Kinked(shape, span * abs(off), at - offset, length)
    kinds: dict[str, Callable[[], HeightsOnly]] = {
        "heights": lambda: HeightsOnly(**plain),
        "slope": lambda: Sloped(**plain),
        "slope false": lambda: Sloped(**plain, factor=1 + off),
        "kink undeclared": lambda: HeightsOnly(**{**plain, "shape": kinked}),
        "kink false": lambda: Phantom(**plain, kink=(at, off * span / length)),
        "symmetric false": lambda: Even(**plain),
    }
    if period is not None:
        kinds["conjugate"] = lambda: Conjugate(**plain)
        kinds["conjugate false"] = lambda: Conjugate(**plain, conjugate=1 + off)
    share = {"heights": 6.0, "slope": 2.0}
    weight = np.array([share.get(kind, 1.0) for kind in kinds])
    kind = str(rng.choice(list(kinds), p=weight / weight.sum()))
    name = kind + (", constant" if constant else "") + (", far" if offset else "")
    return name, kinds[kind]()


@dataclass(frozen=True, eq=False)
class Kinked:
    """A shape with a triangle wave added."""

    shape: Any
    size: float
    at: float
    length: float

    def height(self, x: ArrayLike) -> Array:
        """Heights of the sum [m]."""
        away = (np.asarray(x) - self.at) / self.length
        return np.asarray(self.shape.height(x) + self.size * np.abs(away - np.round(away)))

    def slope(self, x: ArrayLike) -> Array:
        """Slopes of the sum."""
        away = (np.asarray(x) - self.at) / self.length
        side = np.sign(away - np.round(away))
        return np.asarray(self.shape.slope(x) + self.size / self.length * side)


def designed(rng: np.random.Generator, seed: int, length: float, modulus: float) -> Drawn:
    """An inverse-designed contact of one to eight zones."""
    period = length if rng.random() < 0.7 else None
    fraction = float(rng.choice([rng.uniform(0.05, 0.8), 1 - 10 ** rng.uniform(-3, -0.7)]))
    problem = random_problem(
        rng,
        int(rng.integers(1, 9)),
        period,
        E_star=modulus,
        strain=10 ** rng.uniform(-4, -1),
        spread=float(rng.choice([3, 10])),
        fraction=fraction,
        length=length,
    )
    shape: Any = problem.profile
    x = problem.zones.ravel()
    span = float(np.ptp(shape.height(np.linspace(x.min(), x.max(), 500))))
    name, profile = _disguise(rng, shape, period, length, span)
    controls: dict[str, Any] = {"load": problem.load}
    if period is not None:
        controls |= {
            "mean_pressure": problem.mean_pressure,
            "contact_fraction": problem.contact_fraction,
            "approach": problem.approach,
        }
    kind = str(rng.choice(list(controls)))
    interaction = contact.Isolated() if period is None else contact.Periodic()
    scene = contact.Scene(profile, modulus, interaction, **{kind: controls[kind]})
    judge = against(problem, profile.offset)
    if "undeclared" in name:
        judge = against_twin(replace(scene, profile=_declared(profile)))
    return Known(seed, f"designed, {name}", scene, judge)


@dataclass(frozen=True, eq=False)
class Declared(Sloped):
    """A shape of `Kinked` given by heights, slopes and the true kinks of its triangle wave."""

    @property
    def kinks(self) -> Array:
        """The kinks (position, jump of the slope) in the cell, or near an isolated contact."""
        s = self.shape
        at = self.offset + s.at + s.length * np.array([0.0, 0.5])
        jump = 2 * s.size / s.length
        if self.period is None:
            at = self.offset + s.at + s.length * np.arange(-6, 6.5, 0.5)
        else:
            at = np.asarray(self.wrap(at))
        return np.column_stack((at, np.where(np.arange(len(at)) % 2 == 0, jump, -jump)))


def _declared(profile: HeightsOnly) -> Declared:
    return Declared(profile.shape, profile.constant, profile.offset, profile.period)


def full(rng: np.random.Generator, seed: int, length: float, modulus: float) -> Drawn:
    """A Fourier series in full contact."""
    n = int(rng.integers(1, 13))
    k = np.arange(1, n + 1)
    size = length * 10 ** rng.uniform(-5, -2) * rng.normal(size=(2, n)) / k**1.5
    series = contact.Fourier(length, size[0], size[1])
    x = length * np.arange(4096) / 4096
    span = float(np.ptp(series.height(x)))
    least = 0.5 * modulus * float(conjugate(series, x).max())
    name, profile = _disguise(rng, series, length, length, span)
    mean = least * (1 + 10 ** rng.uniform(-3, 2))
    scene = contact.Scene(profile, modulus, contact.Periodic(), mean_pressure=mean)
    if "undeclared" in name:
        twin = replace(scene, profile=_declared(profile))
        return Known(seed, f"full, {name}", scene, against_twin(twin))
    return Known(seed, f"full, {name}", scene, against_full(series, profile.offset))


def closed(rng: np.random.Generator, seed: int, length: float, modulus: float) -> Drawn:
    """One zone of a wave or a parabola, of any width."""
    narrow, wide = 10 ** rng.uniform(-5, -0.1), 1 - 10 ** rng.uniform(-5, -0.5)
    half = 0.5 * length * float(rng.choice([narrow, wide]))
    slope = 10 ** rng.uniform(-4, -1)
    answer: Any
    shape: Any
    if rng.random() < 0.6:
        answer = exact.Westergaard(
            amplitude=slope * length, period=length, E_star=modulus, half_width=half
        )
        shape, period = contact.Sinusoid(slope * length, length), length
    else:
        answer = exact.HertzLine(radius=length / slope, E_star=modulus, half_width=half)
        shape, period = contact.Parabola(length / slope), None
    name, profile = _disguise(rng, shape, period, length, slope * length)
    if "conjugate" in name or "undeclared" in name:
        return designed(rng, seed, length, modulus)
    interaction = contact.Isolated() if period is None else contact.Periodic()
    scene = contact.Scene(profile, modulus, interaction, load=answer.load)
    return Known(seed, f"closed, {name}", scene, against(_At(answer), profile.offset))


@dataclass(frozen=True)
class _At:
    """A closed form of one zone, with the interface of a solution."""

    answer: Any

    @property
    def zones(self) -> Array:
        return np.asarray(self.answer.zones)

    def pressure_at(self, t: Array, zone: int = 0) -> Array:
        return np.asarray(self.answer.pressure_at(t))


@dataclass(frozen=True, eq=False)
class Rippled(contact.Profile):
    """Profile x^2/2R + A (1 - cos 2 pi x/l) + C, given by its heights alone."""

    radius: float
    amplitude: float
    wave: float
    constant: float = 0.0

    def height(self, x: ArrayLike) -> Array:
        """Heights f(x) [m]."""
        x = np.asarray(x)
        ripple = self.amplitude * (1 - np.cos(2 * np.pi * x / self.wave))
        return np.asarray(self.constant + x**2 / (2 * self.radius) + ripple)


@dataclass(frozen=True, eq=False)
class RippledSlope(Rippled):
    """The profile of `Rippled`, given by heights and slopes."""

    def slope(self, x: ArrayLike) -> Array:
        """Slopes f'(x)."""
        x, q = np.asarray(x), 2 * np.pi / self.wave
        return np.asarray(x / self.radius + self.amplitude * q * np.sin(q * x))


def rippled(rng: np.random.Generator, seed: int, length: float, modulus: float) -> Drawn:
    """Ripples on a parabola, in contact in one to some thirty zones."""
    radius, wave = length * 10 ** rng.uniform(0, 2), length * 10 ** rng.uniform(-3, -1)
    amplitude = wave * 10 ** rng.uniform(-3.5, -1.5)
    # Hertz's zone at this load contains up to about thirty waves.
    half = wave * 10 ** rng.uniform(-1, 1.2)
    load = np.pi * modulus * half**2 / (4 * radius)
    plain = radius, amplitude, wave
    scene = contact.Scene(Rippled(*plain), modulus, contact.Isolated(), load=load)
    twin = replace(scene, profile=RippledSlope(*plain))
    return Known(seed, "rippled, heights", scene, against_twin(twin))


def flat_top(rng: np.random.Generator, seed: int, length: float, modulus: float) -> Drawn:
    """A trace of forty samples with a flat top, at the approach that belongs to a load."""
    heights = np.zeros(40)
    start, count = int(rng.integers(40)), int(rng.integers(1, 12))
    heights[(start + np.arange(count)) % 40] = length * 10 ** rng.uniform(-6, -2)
    if rng.random() < 0.4:
        heights[int(rng.integers(40))] = heights.max() * rng.uniform(0.2, 1)
    profile = contact.Sampled(length * np.arange(40) / 40, heights, period=length)
    plain = contact.Scene(profile, modulus, contact.Periodic(), contact_fraction=1.0)
    load = contact.solve(plain).load * 10 ** rng.uniform(-3, 0)
    loaded = contact.Scene(profile, modulus, contact.Periodic(), load=load)
    approach = contact.solve(loaded, tol=1e-10).approach
    scene = contact.Scene(profile, modulus, contact.Periodic(), approach=approach)
    return Known(seed, "flat top, approach", scene, against_twin(loaded))


def power(rng: np.random.Generator, seed: int, length: float, modulus: float) -> Drawn:
    """A power-law indenter, declared or given by its heights alone."""
    exponent = float(rng.choice([rng.uniform(1.05, 8), 1.5, 2.5, 3.0]))
    half = length * 10 ** rng.uniform(-3, 0)
    coefficient = 10 ** rng.uniform(-3, -1) * length ** (1 - exponent)
    answer = exact.IsolatedPower(coefficient, exponent, modulus, half)
    profile: Any = contact.Power(coefficient, exponent)
    name = "power"
    if rng.random() < 0.3:
        profile, name = HeightsOnly(profile), "power, heights"
    scene = contact.Scene(profile, modulus, contact.Isolated(), load=answer.load)
    return Known(seed, name, scene, against(_At(answer), known_to=1e-12))


Family = Callable[[np.random.Generator, int, float, float], Drawn]

# Every family with its probability.
FAMILIES: tuple[tuple[float, Family], ...] = (
    (0.35, designed),
    (0.15, full),
    (0.15, closed),
    (0.12, rippled),
    (0.12, flat_top),
    (0.11, power),
)


def draw(seed: int) -> Drawn | contact.ContactError:
    """Return the scene of a seed, or the error if the drawn parts do not fit together."""
    rng = np.random.default_rng([4, seed])
    length, modulus = 10.0 ** rng.uniform(-6, 1), 10.0 ** rng.uniform(5, 12)
    share = [share for share, _ in FAMILIES]
    family = FAMILIES[int(rng.choice(len(FAMILIES), p=share))][1]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", contact.ModelWarning)
            return family(rng, seed, length, modulus)
    except contact.ContactError as error:
        return error


if __name__ == "__main__":
    sys.exit(main(draw=draw, description=__doc__))
