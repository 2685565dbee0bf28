"""Traces and their mirror images: one contact solved twice, the two answers held against what both
state.

    python -m contact.studies.mirrored FIRST COUNT [--tol 1e-8] [--points 300]

Of the mirror image all rounding is another one, grids lie elsewhere, zones and gaps are met from
their other side. One line for every scene on which the two differ: `apart`, by more than both
state, is a fault; `other zones` and `one of them` are none where a closure has several strips at
rest, or where rounding decides whether an error is below the tolerance. Then how many there were,
by model.
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import contact
from contact.studies.trace_kinds import KINDS, drawn

Array = NDArray[np.float64]

# Angles of a zone at which pressures are compared, and parts of the full load.
_ANGLES = np.linspace(0.02, np.pi - 0.02, 160)
_LEAST = 2.5
_MOST = 0.02
# Widths that are the same zone's, over the widest.
_SAME = 1e-4


def scene(seed: int, points: int) -> contact.Scene:
    """A trace under some load, model, substrate and law."""
    rng = np.random.default_rng([91, seed])
    profile = drawn(
        rng,
        str(rng.choice(list(KINDS))),
        int(rng.integers(30, points + 1)),
        str(rng.choice(["even", "uneven"])),
    )
    E_star, part = 10.0 ** rng.uniform(6, 11), 10.0 ** -rng.uniform(_MOST, _LEAST)
    full = contact.solve(
        contact.Scene(profile, E_star, contact.Periodic(), contact_fraction=1.0)
    ).load
    period = profile.period
    assert period is not None
    plain = contact.Scene(profile, E_star, contact.Periodic(), load=part * full)
    work = (full / period) ** 2 * period / E_star * 10.0 ** rng.uniform(-5, -2)
    kinds = (
        plain,
        replace(plain, interaction=contact.Localized("self-consistent")),
        replace(plain, interaction=contact.Localized("first-order")),
        replace(
            plain,
            substrate=contact.Layer(period * 10.0 ** rng.uniform(-1.3, 1), rng.uniform(0, 0.49)),
        ),
        replace(plain, law=contact.JKR(work)),
        replace(plain, law=contact.Dugdale(work, full / period * 10.0 ** rng.uniform(-1.5, 0.5))),
    )
    return kinds[int(rng.integers(len(kinds)))]


def mirrored(one: contact.Scene) -> contact.Scene:
    """The scene of the mirror image."""
    trace = one.profile
    assert isinstance(trace, contact.Sampled)
    return replace(
        one,
        profile=contact.Sampled(
            -np.asarray(trace.x)[::-1], np.asarray(trace.heights)[::-1], period=trace.period
        ),
    )


def apart(one: contact.Solution, other: contact.Solution) -> float | None:
    """By what part of what both state the answers differ, in ends over widths and pressures over
    their peak; None of other zones.
    """
    widths, reversed_widths = one.zone_widths, other.zone_widths[::-1]
    if len(widths) != len(reversed_widths):
        return None
    if len(widths) == 0:
        return 0.0
    turns = [
        turn
        for turn in range(len(widths))
        if np.abs(widths - np.roll(reversed_widths, turn)).max() < _SAME * widths.max()
    ]
    if not turns:
        return None
    zone = np.roll(np.arange(len(widths))[::-1], turns[0])
    ends = float((np.abs(widths - other.zone_widths[zone]) / widths).max())
    # Beside a tension the peak is that of both; where ends pull without range, of what is finite.
    stress, finite = (
        one.scene.law.tension,
        np.sin(_ANGLES) if one.scene.law.pulls and one.scene.law.tension == 0.0 else 1.0,
    )
    pairs = [
        (one.pressure_at(np.cos(_ANGLES), k), other.pressure_at(-np.cos(_ANGLES), int(zone[k])))
        for k in range(len(widths))
    ]
    peak = max(float(np.abs((p + stress) * finite).max()) for p, _ in pairs)
    pressure = max(float(np.abs((p - q) * finite).max()) for p, q in pairs) / peak
    return max(0.5 * ends, pressure) / (one.error + other.error)


def told(seed: int, points: int, tol: float) -> tuple[str, str]:
    """(model, what became of a scene and its mirror image)."""
    one = scene(seed, points)
    name = f"{type(one.interaction).__name__}, {type(one.substrate).__name__}, {type(one.law).__name__}"
    found: list[contact.Solution | str] = []
    for each in (one, mirrored(one)):
        try:
            found.append(contact.solve(each, tol))
        except contact.ContactError as error:
            found.append(f"{type(error).__name__}: {error}"[:100])
    first, second = found
    if isinstance(first, str) or isinstance(second, str):
        both = isinstance(first, str) and isinstance(second, str)
        return (
            name,
            "refused" if both else f"one of them: {first if isinstance(first, str) else second}",
        )
    part = apart(first, second)
    if part is None:
        return name, f"other zones: {len(first.zones)} and {len(second.zones)}"
    return (
        name,
        "agree"
        if part <= 1.0
        else f"apart: {part:.2g} of the stated {first.error:.1e} and {second.error:.1e}",
    )


def told_of(first: int, count: int, points: int, tol: float) -> Iterator[tuple[int, str, str]]:
    """(seed, model, what became of it)."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", contact.ModelWarning)
        for seed in range(first, first + count):
            yield seed, *told(seed, points, tol)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="contact.studies.mirrored",
        description=__doc__,
        formatter_class=argparse.RawTextHelpFormatter,
    )
    parser.add_argument("first", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("--tol", type=float, default=1e-8)
    parser.add_argument("--points", type=int, default=300)
    asked = parser.parse_args(arguments)
    counts: Counter[tuple[str, str]] = Counter()
    for seed, name, what in told_of(asked.first, asked.count, asked.points, asked.tol):
        kind = what.split(":")[0]
        counts[name, kind] += 1
        if kind not in ("agree", "refused"):
            print(f"{seed}  {name}  {what}", flush=True)
    for (name, kind), number in sorted(counts.items()):
        print(f"{number:5d}  {name}  {kind}")
    return 1 if any(kind == "apart" for _, kind in counts) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
