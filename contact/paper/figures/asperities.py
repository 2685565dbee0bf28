"""Figures 7 to 12: pressure and contact width of a wave, a wedge and a parabola per period."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from contact.model.profiles import Parabola, Profile, Sinusoid, Wedge
from contact.paper import localized_parabola, localized_wave, localized_wedge
from contact.paper.figures import base
from contact.paper.figures.base import (
    ALONE,
    EXACT,
    FIRST,
    MODELS,
    ONE,
    SELF,
    Figure,
    curve,
    label_panel,
    solved,
    worst,
)
from contact.reference.exact import HertzLine, PeriodicParabola, localized_at_load
from contact.solution.solution import Solution
from sie import Array


@dataclass(frozen=True)
class AsperitiesOfThePaper:
    """The scenes of figures 7 to 12, with E* = 1, the period L = 1 and the radius R = L."""

    # The amplitude of the wave, and also the slope of the wedge. The pressures are proportional to
    # this number.
    scale: float = 0.01
    # The pressure on wave and wedge is drawn at the contact fractions 2a/L in `fractions`. The
    # pressure on the parabola is drawn at the mean pressures, divided by E*, in `pressures`.
    fractions: tuple[float, float] = (0.4, 0.7)
    pressures: tuple[float, float] = (0.05, 0.15)
    # Number of points of each curve that has the contact width as abscissa.
    points: int = 49

    @property
    def wave(self) -> Sinusoid:
        return Sinusoid(self.scale, period=1.0)

    @property
    def wedge(self) -> Wedge:
        return Wedge(self.scale, period=1.0)

    @property
    def parabola(self) -> Parabola:
        return Parabola(radius=1.0, period=1.0)

    def widths(self) -> Array:
        """Contact widths 2a/L from 0.02 to 0.98, the abscissas of curves."""
        return np.round(np.arange(1, self.points + 1) / (self.points + 1), 10)

    def half_widths(self) -> Array:
        """Contact half-widths a/L from 0.01 to 0.49, the abscissas of curves."""
        return np.round(np.arange(1, self.points + 1) / (2.0 * (self.points + 1)), 10)


_SCENES = AsperitiesOfThePaper()
_P_STAR = np.pi * _SCENES.scale
_FRACTIONS = _SCENES.widths()
_SHARES = _SCENES.half_widths()
_LINE = {"color": "black", "linewidth": 0.6}


@dataclass(frozen=True)
class _Pressures:
    """The pressures of several models at several values of a control.

    what: name of the pressure; given: name of the control; unit: the pressures are drawn divided by
    this pressure; every: the solutions by (value of the control, model).
    """

    what: str
    given: str
    unit: float
    every: dict[tuple[float, str], Solution | None]

    @cached_property
    def x(self) -> Array:
        return base.on_cell(self.every.values(), 0.5)

    @cached_property
    def columns(self) -> dict[str, Array]:
        of_models = {
            self.name(*key): base.pressures(solution, self.x) / self.unit
            for key, solution in self.every.items()
        }
        return {"x/L": self.x, **of_models}

    def name(self, value: float, model: str) -> str:
        return f"{self.what} {model} {self.given}={value}"

    def largest_difference(self, value: float, model: str, form: Array, where: Any = ...) -> float:
        """Largest relative difference of a model's pressure from the pressure of a closed form.

        form: pressures of the closed form at the abscissas `self.x`. where: indices or mask of the
        abscissas that are compared.
        """
        return worst(self.columns[self.name(value, model)][where] * self.unit, form[where])

    def figure(
        self,
        number: str,
        title: str,
        notes: tuple[str, ...],
        heading: str,
        label: str,
        top: float | None = None,
    ) -> Figure:
        """The figure of the pressures, with one panel for each value of the control."""

        def draw(figure: Any) -> None:
            values = dict.fromkeys(value for value, _ in self.every)
            for axes, value in zip(figure.subplots(1, len(values)), values, strict=True):
                for of, model in self.every:
                    if of == value:
                        curve(
                            axes,
                            self.x,
                            self.columns[self.name(value, model)],
                            model,
                            "Hertz" if model == ALONE else model,
                        )
                axes.set_title(f"{heading} = {value}", fontsize=9)
                label_panel(axes, "x/L", label, xlim=(-0.5, 0.5), ylim=(0.0, top))

        return Figure(number, title, notes, self.columns, draw)


def _at_widths(
    profile: Profile, half_widths: Array, numbers: Mapping[str, Callable[[Solution], float]]
) -> dict[str, Array]:
    """Table with one column for each quantity in `numbers` and each model, at given half widths.
    A value is nan where a model has no contact of this half width.
    """
    columns: dict[str, Array] = {}
    for model in MODELS:
        found = [solved(profile, model, half_width=a) for a in half_widths]
        columns |= {
            f"{name} {model}": np.array([np.nan if s is None else of(s) for s in found])
            for name, of in numbers.items()
        }
    return columns


def _draw_errors(
    axes: Any, columns: dict[str, Array], names: Mapping[str, float | None], up: str, most: float
) -> None:
    """Draw the models' errors [%], relative to the exact model, against the first column.

    names: the quantities, each with a line width, or None for the line width of the model; up:
    label of the ordinate; most: limit of the ordinate.
    """
    across, x = next(iter(columns.items()))
    for model in (FIRST, SELF, ONE, ALONE):
        for name, width in names.items():
            error = columns[f"{name} {model}"] / columns[f"{name} {EXACT}"] - 1.0
            axes.plot(
                x,
                100.0 * error,
                **{**base.STYLE[model], **({} if width is None else {"linewidth": width})},
            )
    axes.axhline(0.0, **_LINE)
    label_panel(axes, across, up, legend=False, xlim=(0.0, round(x[-1], 1)), ylim=(-most, most))


def figure_7() -> Figure:
    """Figure 7: pressure on a wave at two contact widths."""
    every = {
        (f, m): solved(_SCENES.wave, m, half_width=0.5 * f)
        for f in _SCENES.fractions
        for m in (EXACT, FIRST, SELF, ONE)
    }
    seen = _Pressures("p/p*", "2a/L", _P_STAR, every)
    closed = {f: localized_wave(_SCENES.scale, 1.0, 1.0, 0.5 * f) for f in _SCENES.fractions}
    deviations = [
        seen.largest_difference(f, model, form.pressure(seen.x))
        for f, both in closed.items()
        for model, form in ((FIRST, both), (EXACT, both.exact))
    ]
    errors = ", ".join(
        f"{100 * both.peak_error:+.3g} % at 2a/L = {f}" for f, both in closed.items()
    )
    notes = (
        "p* = pi E* Delta/L. The paper does not state the widths. Here 2a/L is 0.4 and 0.7; at "
        "0.7, according to the paper, the discrepancy begins.",
        "The paper's curve is the first-order one. The curves of the self-consistent closure and "
        "of one explicit neighbour are added.",
        "All curves are computed by the solver. The first-order and exact ones differ from "
        f"(20)-(24) and (18) by at most {max(deviations):.1e} of the peak.",
        f"Error of the first-order largest pressure, relative to the exact one: {errors}.",
    )
    return seen.figure("7", "Pressure on a wave", notes, "2a/L", "p/p*")


def figure_8() -> Figure:
    """Figure 8: mean and largest pressure on a wave against the contact width, with errors."""
    numbers = {"mean/p*": lambda s: s.load / _P_STAR, "max/p*": lambda s: s.max_pressure / _P_STAR}
    columns = {"2a/L": _FRACTIONS, **_at_widths(_SCENES.wave, 0.5 * _FRACTIONS, numbers)}
    first = columns[f"mean/p* {FIRST}"]
    written = (
        np.array(
            [
                localized_wave(_SCENES.scale, 1.0, 1.0, 0.5 * f).mean_pressure
                for f in _FRACTIONS[np.isfinite(first)]
            ]
        )
        / _P_STAR
    )
    error = worst(first[: len(written)], written)
    at = localized_wave(_SCENES.scale, 1.0, 1.0, 0.35)

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        for model in MODELS:
            curve(left, _FRACTIONS, columns[f"mean/p* {model}"], model, model)
            curve(left, _FRACTIONS, columns[f"max/p* {model}"], model)
        left.annotate("greatest", (0.62, 1.42), fontsize=8)
        left.annotate("mean", (0.62, 0.45), fontsize=8)
        label_panel(left, "2a/L", "p/p*", xlim=(0.0, 1.0), ylim=(0.0, 2.1))
        widths = {"mean/p*": 1.4, "max/p*": 0.7}
        _draw_errors(right, columns, widths, "error [%], thick: mean, thin: greatest", 15.0)
        right.axvline(0.7, **_LINE)

    notes = (
        "p* = pi E* Delta/L. The paper's curves are the first-order ones (23), (24) and the exact "
        "(18), (19).",
        "All curves are computed by the solver at given half-widths. The first-order mean pressure "
        f"differs from (23) by at most {error:.1e} of its largest value.",
        f"Errors at 2a/L = 0.7: first-order mean pressure {100 * at.load_error:+.3g} %, "
        f"first-order largest pressure {100 * at.peak_error:+.3g} %, "
        f"isolated mean pressure {100 * at.isolated_load_error:+.3g} %.",
        "An entry is empty if the model has no contact of this width: one wave alone would overlap "
        "the surface at |x| = L/2.",
    )
    return Figure("8", "Mean and largest pressure on a wave", notes, columns, draw)


def figure_9() -> Figure:
    """Figure 9: pressure on a wedge at two contact widths."""
    every = {
        (f, m): solved(_SCENES.wedge, m, half_width=0.5 * f)
        for f in _SCENES.fractions
        for m in (EXACT, FIRST, SELF, ONE)
    }
    seen = _Pressures("p/(E* tan b)", "2a/L", _SCENES.scale, every)
    errors, beside = [], []
    for fraction in _SCENES.fractions:
        closed = localized_wedge(_SCENES.scale, 1.0, 1.0, 0.5 * fraction)
        for model, form in ((FIRST, closed), (EXACT, closed.exact)):
            errors.append(
                seen.largest_difference(
                    fraction, model, form.pressure(seen.x), np.abs(seen.x) > 1e-3
                )
            )
        t = np.linspace(0.01, 0.99, 99)
        difference = (
            np.max(np.abs(closed.pressure_at(t) - closed.exact.pressure_at(t)))
            / closed.exact.load
            * fraction
        )
        beside.append(f"{100 * difference:.3g} % at 2a/L = {fraction}")
    notes = (
        "b is the angle of the wedge. The paper gives no widths: 2a/L = 0.4 and 0.7 are chosen, as "
        "for the wave.",
        "The entry at x = 0 is empty, as the pressure is infinite there. The paper's curve is the "
        "first-order one, (26) with |x| in place of x.",
        "All curves are computed by the solver. For |x| > 0.001 L, the first-order and exact ones "
        f"differ from (26) and (25) by at most {max(errors):.1e} of the largest pressure there.",
        "Largest difference between the first-order and the exact pressure, divided by the mean "
        f"pressure on the zone: {', '.join(beside)}.",
    )
    return seen.figure("9", "Pressure on a wedge", notes, "2a/L", r"p/(E* tan$\,\beta$)", 1.6)


def figure_10() -> Figure:
    """Figure 10: contact width of a wedge against the mean pressure."""
    mean = "mean/(E* tan b)"
    columns = {
        "2a/L": _FRACTIONS,
        **_at_widths(_SCENES.wedge, 0.5 * _FRACTIONS, {mean: lambda s: s.load / _SCENES.scale}),
    }
    written = (
        np.array(
            [localized_wedge(_SCENES.scale, 1.0, 1.0, 0.5 * f).mean_pressure for f in _FRACTIONS]
        )
        / _SCENES.scale
    )
    error = worst(columns[f"{mean} {FIRST}"], written)
    at = localized_wedge(_SCENES.scale, 1.0, 1.0, 0.35)

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        for model in MODELS:
            curve(left, columns[f"{mean} {model}"], _FRACTIONS, model, model)
        left.axhline(0.7, **_LINE)
        label_panel(left, r"$\bar p$/(E* tan$\,\beta$)", "2a/L", xlim=(0.0, 1.1), ylim=(0.0, 1.0))
        _draw_errors(right, columns, {mean: None}, "error of the mean pressure [%]", 30.0)
        right.axvline(0.7, **_LINE)

    notes = (
        "b is the wedge's angle. The paper's curves are the first-order (27) and the exact E* tan "
        "b artanh(sin(pi a/L))/pi.",
        "All curves are computed by the solver at given half-widths. The first-order one differs "
        f"from (27) by at most {error:.1e} of its largest value.",
        f"Errors of the mean pressure at 2a/L = 0.7: first-order {100 * at.load_error:+.3g} %, "
        f"isolated {100 * at.isolated_load_error:+.3g} %.",
    )
    return Figure("10", "Width of contact of a wedge", notes, columns, draw)


def figure_11() -> Figure:
    """Figure 11: pressure on a parabola at two mean pressures, with the exact solution added."""
    every = {
        (p, m): solved(_SCENES.parabola, m, mean_pressure=p)
        for p in _SCENES.pressures
        for m in (EXACT, FIRST, SELF, ALONE)
    }
    errors, t = [], np.linspace(-1.0, 1.0, 201)
    for mean in _SCENES.pressures:
        exact = PeriodicParabola.from_mean_pressure(mean, period=1.0, radius=1.0, E_star=1.0)
        first = localized_at_load(HertzLine, mean, period=1.0, radius=1.0, E_star=1.0)
        for model, form in ((EXACT, exact), (FIRST, first)):
            solution = every[mean, model]
            assert solution is not None
            errors.append(worst(solution.pressure_at(t), form.pressure_at(t)))
    notes = (
        "mean is the mean pressure divided by E*: 0.05 and 0.15, as in the paper. The paper does "
        "not state R/L; here R = L.",
        "The isolated solution is Hertz's. The exact one, which the paper regards as unknown, is "
        "p = (L E*/2 pi R) arcosh(cos(pi x/L)/cos(pi a/L)).",
        "All curves are computed by the solver. The exact and first-order ones differ from closed "
        f"forms by at most {max(errors):.1e} of the peak.",
        *(
            f"mean {mean}, {model}: a/L = {0.5 * s.zone_widths[0]:.5f}, peak {s.max_pressure:.5f} "
            "E*"
            for (mean, model), s in every.items()
            if s is not None
        ),
    )
    return _Pressures("p/E*", "mean", 1.0, every).figure(
        "11", "Pressure on parabolic asperities", notes, r"$\bar p$/E*", "p/E*"
    )


def figure_12() -> Figure:
    """Figure 12: contact half-width of a parabola against the load."""
    load = "P R/(L^2 E*)"
    columns = {"a/L": _SHARES, **_at_widths(_SCENES.parabola, _SHARES, {load: lambda s: s.load})}
    closed = [localized_parabola(1.0, 1.0, 1.0, a) for a in _SHARES]
    error = worst(columns[f"{load} {FIRST}"], np.array([c.load for c in closed]))
    kuznetsov = worst(columns[f"{load} {EXACT}"], np.array([c.exact.load for c in closed]))
    end, low = localized_parabola(1.0, 1.0, 1.0, 0.35), localized_parabola(1.0, 1.0, 1.0, 0.125)
    hertz_width = float(np.sqrt(4.0 * low.exact.load / np.pi)) / 0.125 - 1.0

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        for model in MODELS:
            curve(
                left,
                columns[f"{load} {model}"],
                _SHARES,
                model,
                "Hertz" if model == ALONE else model,
            )
        for axes in (left.axhline, right.axvline):
            for share in (0.125, 0.35):
                axes(share, **_LINE)
        label_panel(left, "P R/(L² E*)", "a/L", xlim=(0.0, 0.4), ylim=(0.0, 0.5))
        _draw_errors(right, columns, {load: None}, "error of the load [%]", 30.0)

    notes = (
        "The paper's curves are the first-order (30), the exact (28) and Hertz's.",
        "All curves are computed by the solver at given half-widths. The first-order loads differ "
        f"from (30) by at most {error:.1e}, the exact ones from (28) by at most {kuznetsov:.1e} "
        "of the largest load.",
        f"Errors of Hertz's solution at a/L = 0.125: {100 * low.isolated_load_error:+.3g} % in "
        f"load at the same width, {100 * hertz_width:+.3g} % in width at the same load.",
        f"Errors of the load at a/L = 0.35: first-order {100 * end.load_error:+.3g} %, Hertz "
        f"{100 * end.isolated_load_error:+.3g} %.",
    )
    return Figure("12", "Width of contact of parabolic asperities", notes, columns, draw)
