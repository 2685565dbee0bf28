"""Stiff and extreme scenes, each with its exact answer and what rounding of its data allows.

`condition` is how much the stated measure (pressure over the peak, ends over widths) may change for a relative change of the
load or the slope: known in closed form, or bounded as its reason says. What is allowed is 100 roundings times that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from math import pi, sin, sqrt, tan

import numpy as np

from contact.bench.cases import best
from contact.bench.harmonics import HarmonicZone
from contact.bench.hyperbola import BluntedWedge, IsolatedBluntedWedge
from contact.bench.nearly_full import FromGaps, LoneGap
from contact.bench.power import PowerPunch, Repeated
from contact.bench.truth import Exact
from contact.exact import HertzLine, IsolatedBiquadratic, IsolatedWedge, Westergaard
from contact.interactions import Isolated, Periodic
from contact.inverse import DesignedContact, design
from contact.profiles import Biquadratic, Fourier, Parabola, Polynomial, Profile, Sampled, Sinusoid, Wedge
from contact.scene import Scene
from contact.solver import solve

# What is allowed of a well-conditioned scene: the solver states no error below some 5e-14.
FLOOR = 1e-13
ROUNDINGS = 100


@dataclass(frozen=True, eq=False)
class Extreme:
    """One case: what is extreme, the scene, its truth, its condition and why; known: why it is known to fail, if it is."""

    group: str
    name: str
    make: Callable[[], tuple[Scene, Exact]] = field(repr=False)
    condition: float
    why: str
    heavy: bool = False
    known: str = ""

    @property
    def allowed(self) -> float:
        return max(FLOOR, ROUNDINGS * 2.2e-16 * self.condition)


def _wave(fraction: float, E_star: float = 1.0, period: float = 1.0, amplitude: float = 1e-2) -> tuple[Scene, Exact]:
    exact = Westergaard.from_contact_fraction(fraction, amplitude=amplitude, period=period, E_star=E_star)
    return Scene(Sinusoid(amplitude, period), E_star, Periodic(), mean_pressure=exact.mean_pressure), exact


def fractions() -> Iterator[Extreme]:
    """Westergaard: p/p* = sin^2 A, so d ln a / d ln p = tan(A) / 2A, A = pi a / L."""
    for rest in (1e-6, 1e-3, 0.1):
        angle = 0.5 * pi * rest
        yield Extreme(
            "contact of the period", f"wave, {rest:g}", partial(_wave, rest), tan(angle) / (2 * angle), "tan(A)/2A"
        )
    for rest in (0.5, 1e-2, 1e-3, 1e-4, 1e-6):
        # The exact half width comes from the same rounded load: the load, not the fraction, is the datum.
        angle = 0.5 * pi * (1 - rest)
        yield Extreme(
            "contact of the period", f"wave, 1 - {rest:g}", partial(_near_full, sin(0.5 * pi * rest) ** 2),
            tan(angle) / (2 * angle), "tan(A)/2A",
        )


def _near_full(below: float) -> tuple[Scene, Exact]:
    """The wave at the representable mean pressure p* (1 - below); its exact zone from what the rounded pressure lacks."""
    amplitude = 1 / pi  # p* = E* pi A / L = 1 but for the rounding of pi
    pressure = 1.0 - below
    lack = _rounded_lack(amplitude, pressure)
    half = 0.5 - np.arcsin(sqrt(lack)) / pi
    exact = Westergaard(amplitude=amplitude, period=1.0, E_star=1.0, half_width=float(half))
    return Scene(Sinusoid(amplitude, 1.0), 1.0, Periodic(), mean_pressure=pressure), exact


def _rounded_lack(amplitude: float, pressure: float) -> float:
    """(p* - p) / p* of the doubles that are given, with pi to twice the digits: pi = math.pi + 1.2246e-16."""
    high = np.longdouble(pi) + np.longdouble(1.2246467991473532e-16)
    full = high * np.longdouble(amplitude)
    return float((full - np.longdouble(pressure)) / full)


def loads_near_full() -> Iterator[Extreme]:
    for part in (1e-6, 1e-9, 1e-12):
        yield Extreme(
            "load below full contact by", f"{part:g} of it", partial(_near_full, part), 1 / (pi * sqrt(part)),
            "1/(pi sqrt(part)): tan(A)/2A",
        )
    for part in (1e-6, 1e-9, 1e-12):
        yield Extreme(
            "load below full contact by", f"{part:g} of it, six harmonics", partial(_series_near_full, part),
            1 / sqrt(part), "1/sqrt(part)",
        )


def _series_near_full(part: float) -> tuple[Scene, Exact]:
    """Six harmonics; judged by the gaps' formulation with a tighter inner tolerance than `solve` asks of it."""
    rng = np.random.default_rng(1)
    profile = Fourier(1.0, 1e-3 * rng.normal(size=6), 1e-3 * rng.normal(size=6))
    full = solve(Scene(profile, 1.0, Periodic(), contact_fraction=1.0)).mean_pressure
    assert full is not None
    scene = Scene(profile, 1.0, Periodic(), mean_pressure=full * (1 - part))
    # Where the gap is narrow beyond what the gaps' formulation certifies, the expansion about it is exact to w^2.
    return scene, FromGaps(scene) if part > 1e-7 else LoneGap.of(profile, full, scene)


def _designed(zones: list[list[float]], period: float | None, load: float = 0.05) -> tuple[Scene, DesignedContact]:
    exact = design(zones, 1.0, load, period)
    return Scene(exact.profile, 1.0, Isolated() if period is None else Periodic(), load=load), exact


def gaps() -> Iterator[Extreme]:
    """Between zones of width w a gap g opens by ~ g^3 of a height of order w. Heights known to eps move its root by eps / g^2:
    the condition is (w/g)^2, and towards g/w = eps^(1/3) = 6e-6 merged and split are the same answer to rounded heights."""
    horizon = (
        "the gap opens by (g/w)^3 of the heights, a few of their roundings or less: merged and split are one answer in doubles"
    )
    for gap in (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7):
        for period in (None, 4.0):
            where = "isolated" if period is None else "periodic"
            yield Extreme(
                "gap between zones", f"{gap:g} of the width, {where}",
                partial(_designed, [[-1 - gap / 2, -gap / 2], [gap / 2, 1 + gap / 2]], period), 1 / gap**2, "(w/g)^2",
                known=horizon if gap < 2e-5 else "",
            )
    yield Extreme(
        "gap between zones", "1e-3, zones 1 : 0.05", partial(_designed, [[-1, 0], [1e-3, 0.051]], None), 1e6 / 0.05,
        "(w/g)^2 of the wide zone, over the narrow one's width",
    )


def scales() -> Iterator[Extreme]:
    """A zone of width r beside one of width 1 carries ~ r^2 of the load per height; heights known to eps change its level, and
    with it its load, by eps: its width by eps / r^2 of itself."""
    for ratio in (1e-2, 1e-4, 1e-6):
        for period in (None, 4.0):
            yield Extreme(
                "zones of very different width", f"1 : {ratio:g}, {'isolated' if period is None else 'periodic'}",
                partial(_designed, [[-1.0, 0.0], [0.5, 0.5 + ratio]], period), 1 / ratio**2, "ratio^-2",
            )
    for order, ratio in ((40, 1e-3), (40, 1e-6), (1000, 1e-6)):
        yield Extreme(
            "heights of very different scale", f"a wave and one {order} times shorter, 1 : {ratio:g}",
            partial(_waves, order, ratio), 4.0 + order * order * ratio, "tan(A)/2A, and the curvatures' ratio",
        )


def _waves(order: int, ratio: float) -> tuple[Scene, Exact]:
    amplitudes = np.zeros(order)
    amplitudes[0], amplitudes[-1] = 1e-2, 1e-2 * ratio
    exact = HarmonicZone(tuple(amplitudes), 1.0, 0.4)
    return Scene(Fourier(1.0, -amplitudes), 1.0, Periodic(), mean_pressure=exact.load), exact


def units() -> Iterator[Extreme]:
    for power in (-12, -6, 6, 12):
        yield Extreme(
            "moduli", f"E* = 1e{power} Pa", partial(_wave, 0.4, 10.0**power), 1.0, "a unit changes nothing"
        )
        yield Extreme(
            "lengths", f"L = 1e{power} m", partial(_wave, 0.4, 1.0, 10.0**power, 10.0 ** (power - 2)), 1.0,
            "a unit changes nothing",
        )
    yield Extreme("lengths", "Hertz, R = 1e12 m", partial(_hertz, 1e12), 1.0, "a unit changes nothing")
    yield Extreme("lengths", "Hertz, R = 1e-12 m", partial(_hertz, 1e-12), 1.0, "a unit changes nothing")


def _hertz(radius: float) -> tuple[Scene, Exact]:
    exact = HertzLine(radius=radius, E_star=1e11, half_width=1e-3 * radius)
    return Scene(Parabola(radius), 1e11, Isolated(), load=exact.load), exact


def merges() -> Iterator[Extreme]:
    """The gap between the zones is about sqrt(part) wide, and known from rounded heights as any gap is: to eps / part."""
    horizon = "the gap is 1e-6 wide and opens by 1e-18 of the heights: merged and split are one answer in doubles"
    near = "the gap is 3e-5 of the zones' width and opens by 3e-14 of the heights: the search takes it for closed"
    for part in (1e-3, 1e-6, 1e-9, 1e-12):
        yield Extreme(
            "load below a merge by", f"{part:g} of it", partial(_biquadratic, 1 - part), 1 / part, "(w/g)^2 = 1/part",
            known=horizon if part < 1e-11 else near if part < 1e-8 else "",
        )
    for part in (1e-3, 1e-6, 1e-9, 1e-12):
        yield Extreme(
            "load above a merge by", f"{part:g} of it", partial(_biquadratic, 1 + part), 1 / sqrt(part), "1/sqrt(part)"
        )


def _biquadratic(share: float) -> tuple[Scene, Exact]:
    """The isolated biquadratic at a part of the load at which its zones meet."""
    merging = IsolatedBiquadratic(radius=1.0, spacing=2.0, E_star=1.0, load=1.0).merging_load
    exact = IsolatedBiquadratic(radius=1.0, spacing=2.0, E_star=1.0, load=share * merging)
    return Scene(Biquadratic(1.0, 2.0), 1.0, Isolated(), load=exact.load), exact


def slopes() -> Iterator[Extreme]:
    for steep in (1e-6, 1e6):
        yield Extreme("slopes", f"wedge, slope {steep:g}", partial(_wedge, steep), 1.0, "linear in the slope")
    yield Extreme("slopes", "wave, slope 6e6", partial(_wave, 0.4, amplitude=1e6), 1.0, "linear in the slope")
    yield Extreme("slopes", "x^20", partial(_power, 20), 20.0, "the order of the power")
    yield Extreme("slopes", "x^100", partial(_power, 100), 100.0, "the order of the power")
    undeclared = "an undeclared corner: its slope turns within less than 8192 modes see; declare it as a kink"
    for width in (1e-1, 1e-2, 1e-3, 1e-6):
        yield Extreme(
            "slopes", f"wedge blunted over {width:g} of its contact", partial(_blunted, width), 1.0, "p' ~ ln(a/x)",
            known=undeclared if width < 5e-3 else "",
        )


def _wedge(slope: float) -> tuple[Scene, Exact]:
    exact = IsolatedWedge(wedge_slope=slope, E_star=1.0, half_width=1.0)
    return Scene(Wedge(slope), 1.0, Isolated(), load=exact.load), exact


def _blunted(rounding: float) -> tuple[Scene, Exact]:
    exact = IsolatedBluntedWedge(0.1, rounding, 1.0, 1.0)
    return Scene(BluntedWedge(0.1, rounding), 1.0, Isolated(), load=exact.load), exact


def _power(order: int) -> tuple[Scene, Exact]:
    exact = PowerPunch(order)
    coefficients = np.zeros(order + 1)
    coefficients[-1] = 1 / order
    return Scene(Polynomial(coefficients), 1.0, Isolated(), load=exact.load), exact


def large() -> Iterator[Extreme]:
    why = "positions are rounded to eps L, zones are L/50n wide"
    yield Extreme("many zones", "101 equal zones", partial(_equal, 101), 50.0 * 101, why)
    yield Extreme("many zones", "1001 equal zones", partial(_equal, 1001), 50.0 * 1001, why, heavy=True)
    broken = "from sample to sample the slope changes by as much as it does over the contact: the ends of zones of that size do not settle"
    for samples, noise in ((10_000, 1e-8), (100_000, 1e-9), (100_000, 1e-8)):
        yield Extreme(
            "measured with noise", f"{samples:.0e} samples, {noise:g} of the period", partial(_noisy, samples, noise), 1e8,
            "the slope's noise: rounding of the heights over the pitch and over 1e-3", heavy=samples > 10_000,
            known=broken if samples * noise > 5e-4 else "",
        )


def _equal(zones: int) -> tuple[Scene, Exact]:
    """n waves a period, each in contact on 2 % of its length."""
    amplitude = 1e-3 / zones
    one = Westergaard.from_contact_fraction(0.02, amplitude=amplitude, period=1 / zones, E_star=1.0)
    profile = Fourier(1.0, [0.0] * (zones - 1) + [-amplitude])
    scene = Scene(profile, 1.0, Periodic(), mean_pressure=one.mean_pressure)
    return scene, Repeated(one, zones)


def _noisy(samples: int, noise: float) -> tuple[Scene, Exact]:
    """A rough profile of 64 harmonics, 1e-3 of the period high, sampled with white noise; judged by the same formulation run
    to a tighter tolerance, since no other is known for it."""
    rng = np.random.default_rng(5)
    k = np.arange(1, 65)
    x = np.arange(samples) / samples
    smooth = np.cos(2 * pi * np.outer(x, k) + rng.uniform(0, 2 * pi, 64)) @ (1e-3 * np.maximum(k, 4) ** -1.3)
    profile: Profile = Sampled(x, smooth + noise * rng.normal(size=samples), period=1.0)
    scene = Scene(profile, 1.0, Periodic(), mean_pressure=1e-5)
    return scene, best(scene, 1e-10)


GROUPS: tuple[Callable[[], Iterator[Extreme]], ...] = (
    fractions, loads_near_full, gaps, merges, scales, units, slopes, large,
)


def matrix(quick: bool) -> list[Extreme]:
    """All cases, or those that take no more than about a second."""
    return [case for group in GROUPS for case in group() if not (quick and case.heavy)]


