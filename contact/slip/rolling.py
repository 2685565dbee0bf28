r"""Steady rolling with friction: each stick zone begins at the leading edge of a contact zone.

The body's profile stands still in the frame of the contact, like the profile of a wheel. Then the
strain of one surface against the other is constant where the surfaces stick, and the shear q is

    |q| = mu p - q',    T q' = mu [(E*/2) f' + theta] on the zones that stick.

Here p is the pressure, T the transform by the kernel, f' the slope of the profile and theta a
constant. The leading end of each zone that sticks is the leading end of a zone of contact, and
q' = 0 at both ends of the zone that sticks. The places of the other ends, and theta, follow. The
creepage is 2 mu theta / E*, with the sign of the shear (F. W. Carter, Proc. R. Soc. Lond. A 112,
1926, 151-157, for one parabola). All zones share the creepage.

Two conditions are checked: the shear opposes the slip where the surfaces slip, and q' <= 2 mu p
where they stick. A zone in which one of them fails would stick in several places, and is refused.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

import sie
from contact.errors import NotConverged, SceneError
from contact.formulation.fields import ZoneFields
from contact.formulation.problem import Problem
from contact.formulation.quadrature import chebyshev_nodes
from contact.inside.field import unit_pressure
from contact.model.checks import finite, one_of
from contact.search.options import SEARCH
from contact.slip.checks import friction_of, require_similar, tangential_load_of
from contact.slip.result import Slip, Term, stated_error
from contact.slip.zones import parted
from contact.solution.solution import Solution
from contact.solver import tolerance
from contact.verify.minima import SAMPLING
from sie import Array, Mask, record


@dataclass(frozen=True)
class RollingOptions:
    """Options of the search for the zones that stick, and tolerances of its checks."""

    # A sticking zone narrower than this fraction of its contact zone is left out. If the slip in
    # its place has the wrong sign, the zone is added again. 1e-9 to 1e-3 give the same answers.
    vanished_width: float = 1e-6
    # A value of the wrong sign counts only above this part of the largest value. Smaller values of
    # the wrong sign are errors of the equation's solution.
    sign_tolerance: float = 1e-6
    # Error of the zones that stick, divided by the error of the given contact that causes it.
    of_contact: float = 4.0


OPTIONS = RollingOptions()


@record
class StickFields(ZoneFields):
    """The fields of q'/mu, a pressure on the zones that stick (see the module's docstring).
    There q' is the friction times the pressure, minus the shear.
    """

    stiffness = approach = None

    @property
    def levels(self) -> Array:  # type: ignore[override]
        return np.zeros(len(self.density.zones))


def rolling(
    solution: Solution,
    friction: float,
    tangential_load: float | None = None,
    creepage: float | None = None,
    leading: str = "right",
    tol: float = 1e-8,
) -> Slip:
    """Shear, slip and creepage of a contact in steady rolling.

    Parameters
    ----------
    solution : Solution
        A contact without friction, isolated.
    friction : float
        Coefficient of friction [1], above 0.
    tangential_load : float or None
        Q [N/m], the traction on body 1 along +x; at most friction times the load in size.
    creepage : float or None
        Velocity of body 2 against body 1 along +x, divided by the speed of rolling [1]. Exactly
        one of tangential_load and creepage is given. From some creepage on, everything slides.
    leading : str
        "right" if the contact moves to larger x, "left" if it moves to smaller x.
    tol : float
        Largest stated error of the zones that stick. `Slip.error` also contains the error of
        `solution`.

    Returns
    -------
    Slip
        With its `creepage`.

    Raises
    ------
    SceneError
        If a value is bad, the profile repeats or has sharp corners in contact, the shear does not
        follow from pressures (see `contact.partial_slip`), or a zone would stick in several
        places.
    NotConverged
        If the zones that stick were not found to the tolerance.

    Examples
    --------
    A wheel that transmits three quarters of mu P (F. W. Carter, Proc. R. Soc. Lond. A 112, 1926,
    151-157): half of its contact sticks, and the creepage is mu a / (2 R).

    >>> import contact
    >>> scene = contact.Scene(contact.Parabola(1.0), 1e9, contact.Isolated(), half_width=0.1)
    >>> wheel = contact.solve(scene)
    >>> slip = contact.rolling(wheel, 0.5, tangential_load=0.75 * 0.5 * wheel.load)
    >>> (slip.stick_zones + 0.1).round(9).tolist(), round(slip.creepage, 9)
    ([[0.1, 0.2]], 0.025)
    """
    if not isinstance(solution, Solution):
        raise SceneError.of("solution", solution, "a contact.Solution")
    require_similar(solution.scene)
    _require_wheel(solution)
    mu = friction_of(friction)
    one_of("leading", leading, ("right", "left"))
    tol = tolerance(tol)
    if (tangential_load is None) == (creepage is None):
        raise SceneError.of(
            "tangential_load and creepage",
            (tangential_load, creepage),
            "a pair with only one of them given: the other is part of the solution",
        )
    asked = Rolling(solution, mu, leading == "right", tol)
    if creepage is None:
        shear = tangential_load_of(tangential_load, mu, solution.load)
        return asked.under_load(shear)
    return asked.under_creepage(finite("creepage", creepage))


def _require_wheel(solution: Solution) -> None:
    """Raise SceneError unless the contact may roll steadily."""
    profile, zones = solution.scene.profile, solution.zones
    if solution.scene.period is not None:
        raise SceneError(
            "interaction: a periodic profile that rolls does not keep its shape in the frame of "
            "the contact, so that its rolling is not steady: use contact.Isolated()",
            "interaction",
        )
    if profile.support is not None and len(zones):
        lo, hi = profile.support
        near = 8 * np.spacing(max(abs(lo), abs(hi)))
        if zones[0, 0] <= lo + near or zones[-1, 1] >= hi - near:
            raise SceneError(
                "profile: a body cannot roll steadily over a sharp corner at the end of its "
                "contact: use a profile whose contact ends smoothly",
                "profile",
            )


@dataclass(frozen=True)
class Rolling:
    """A contact that rolls, with a coefficient of friction.

    Parameters
    ----------
    solution : Solution
        The contact.
    friction : float
        Coefficient of friction [1].
    to_right : bool
        Whether the leading ends of zones are their right ends.
    tol : float
        Largest stated error of the zones that stick. `Slip.error` also contains the error of
        `solution`.
    """

    solution: Solution
    friction: float
    to_right: bool
    tol: float

    @property
    def problem(self) -> Problem:
        """The frictionless contact problem in scaled variables."""
        return self.solution.fields.problem

    @property
    def zones(self) -> Array:
        """The scaled zones of the contact (n, 2)."""
        return self.problem.units.scaled(self.solution.zones + self.solution.zone_remainders)

    @property
    def _creepage_unit(self) -> float:
        """Creepage, for a positive shear, divided by theta.
        theta is the scaled constant in the equation of stick (head of this module).
        """
        return self.friction * self.problem.units.slope * (-1.0 if self.to_right else 1.0)

    def under_load(self, shear: float) -> Slip:
        """The `Slip` under the tangential load `shear` [N/m]."""
        load = self.solution.load
        rest = load - abs(shear) / self.friction
        if shear == 0.0:
            return self._whole(0.0, self.solution.zones, 0.0)
        if rest <= 8 * np.finfo(float).eps * load:
            return self._whole(shear, np.zeros((0, 2)), None)
        units = self.problem.units
        found = self._stick(lambda part: sie.Total((load + part * (rest - load)) / units.load))
        return self._slip(found, float(np.sign(shear)), shear)

    def under_creepage(self, creepage: float) -> Slip:
        """The `Slip` under a given creepage."""
        if creepage == 0.0:
            return self._whole(0.0, self.solution.zones, 0.0)
        sign = float(np.sign(creepage))
        theta = abs(creepage) / self._creepage_unit
        if not self._slips_wrongly(None, theta, np.zeros(len(self.zones))).any():
            return self._whole(
                sign * self.friction * self.solution.load, np.zeros((0, 2)), creepage
            )
        found = self._stick(lambda part: sie.Amplitude(0, part * theta))
        rest = found.density.total * self.problem.units.load
        return self._slip(found, sign, sign * self.friction * (self.solution.load - rest))

    def _stick(self, condition: Callable[[float], sie.Condition]) -> sie.Solution:
        """The density q'/mu on the zones that stick, from the integral equation.
        The shear |q| = mu p - q' is smaller than mu p by q', with the pressure p and the friction
        mu.

        condition: the total of q'/mu, or theta, at a fraction of the way from full stick.
        """
        widths = np.diff(self.zones)[:, 0]
        # If Newton's method fails for `part`, the step from `done` to `part` is halved.
        done, part = 0.0, 1.0
        for _ in range(SEARCH.max_loads):
            equation = self._equation(condition(part))
            near = self._near(equation, widths)
            if near is None:
                part = 0.5 * (done + part)
                continue
            free, widths = near
            if part == 1.0:
                return self._finished(equation, free, widths)
            done, part = part, 1.0
        raise NotConverged("not converged: the stick zones were not found", (), self.solution)

    def _equation(self, condition: sie.Condition) -> sie.Equation:
        """Scaled integral equation of q'/mu on the stick zones, with the unknown amplitude theta.
        q' is the friction mu times the pressure, minus the shear. theta is proportional to the
        creepage.
        """
        column = sie.Forcing(np.ones_like, _identity, resolution=sie.Resolution(modes=1))
        return sie.Equation(self.problem.kernel, self.problem.forcing, (condition,), (column,))

    def _near(self, equation: sie.Equation, widths: Array) -> tuple[sie.Free, Array] | None:
        """(stick zones found from the guess `widths`, their widths); None if they are not found.

        Zones in which nothing sticks vanish in the search and get the width 0; those in which the
        slip would then have the wrong sign are added again.
        """
        contact, width = self.zones, np.diff(self.zones)[:, 0]
        side = 1 if self.to_right else 0
        options = sie.NewtonOptions(allow_loss=True)
        for _ in range(2 * len(contact) + 1):
            try:
                with np.errstate(all="ignore"):
                    free = sie.find_ends(equation, self._stuck(widths), self.tol, options)
            except sie.SingularSystem:
                return None
            table = free.density.zones.table
            own = np.abs(table[:, side, None] - contact[:, side]).argmin(axis=1)
            found = np.zeros(len(contact))
            found[own] = np.diff(table)[:, 0]
            if free.converged:
                # A stick zone wider than its contact zone spans a gap: the search has joined two
                # stick zones and lost the slip between them.
                if (found > (1 + self.tol) * width).any():
                    return None
                theta = float(free.density.amplitudes[0])
                wrong = self._slips_wrongly(free.density, theta, found) & (found == 0.0)
                if not wrong.any():
                    return free, found
                widths = np.where(wrong, SEARCH.doubtful_part * width, found)
                continue
            vanished = (widths > 0.0) & (found < OPTIONS.vanished_width * width)
            widths = np.where(vanished, 0.0, widths)
            if not vanished.any() or not widths.any():
                return None
        return None

    def _stuck(self, widths: Array) -> sie.Zones:
        """Scaled stick zones of these widths at the leading ends of the contact zones.
        A width 0 gives no stick zone.
        """
        active = widths > 0.0
        contact, widths = self.zones[active], widths[active]
        if self.to_right:
            table = np.column_stack((contact[:, 1] - widths, contact[:, 1]))
            return sie.Zones.of(table, sie.FREE, sie.BOUNDED)
        table = np.column_stack((contact[:, 0], contact[:, 0] + widths))
        return sie.Zones.of(table, sie.BOUNDED, sie.FREE)

    def _finished(self, equation: sie.Equation, free: sie.Free, widths: Array) -> sie.Solution:
        """The solution with its stated error; SceneError if shear or slip violate Coulomb's law."""
        try:
            found = sie.solve(equation, free.density.zones, self.tol)
        except sie.NotConverged as error:
            # A q' that is a small part of the shear needs fewer digits than `self.tol` asks for.
            # So `error.best` may suffice: `_slip` checks its error.
            if error.best is None:
                raise NotConverged(
                    f"not converged: the stick zones: {error.reason}", (), self.solution
                ) from error
            found = error.best
        sticks = found.zones.table
        nodes = chebyshev_nodes(SAMPLING.min_points)
        at = (sticks.mean(axis=1, keepdims=True) + 0.5 * np.diff(sticks) * nodes).ravel()
        part, units = found.density(at), self.problem.units
        pressure = self.solution.fields.pressure(units.x(at)) / units.pressure
        margin = OPTIONS.sign_tolerance * float(pressure.max())
        wrong = self._slips_wrongly(found.density, float(found.amplitudes[0]), widths)
        if (part < -margin).any() or (part > 2 * pressure + margin).any() or wrong.any():
            raise SceneError(
                "profile: a contact zone would stick in several places, or away from its leading "
                "edge; this case is not solved: use a smoother profile, or another load",
                "profile",
            )
        return found

    def _slips_wrongly(self, density: sie.AnyDensity | None, theta: float, widths: Array) -> Mask:
        """Mask of the contact zones that have a point at which friction does not oppose the slip.

        density: the scaled q'/mu on zones that stick, of the given widths; None if nothing sticks.
        """
        slip = self.zones.copy()
        if self.to_right:
            slip[:, 1] -= widths
        else:
            slip[:, 0] += widths
        nodes = chebyshev_nodes(SAMPLING.min_points)
        x = slip.mean(axis=1, keepdims=True) + 0.5 * np.diff(slip) * np.append(nodes, [-1.0, 1.0])
        slope = self.problem.slope(x)
        rate = -slope - theta
        if density is not None:
            rate = rate + density.transform(x.ravel()).reshape(x.shape)
        rate = rate if self.to_right else -rate
        size = max(float(np.abs(slope).max()), abs(theta))
        return np.asarray((rate < -OPTIONS.sign_tolerance * size).any(axis=1))

    def _slip(self, found: sie.Solution, sign: float, shear: float) -> Slip:
        """The `Slip` with the stick zones of `found`; NotConverged if their error exceeds `tol`."""
        fields, solution = StickFields(self.problem, found.state), self.solution
        size = found.state.size * self.problem.units.pressure
        peak = unit_pressure(solution.fields)
        width = float(np.diff(found.zones.table).max() / np.diff(self.zones).min())
        own = found.error * max(size / peak, min(width, 1.0))
        if own > self.tol:
            raise NotConverged(
                f"the stated error {own:.2g} of the stick zones is above the tolerance "
                f"{self.tol:.2g}",
                (),
                solution,
            )
        of_contact = OPTIONS.of_contact * solution.error
        error = found.error * max(1.0, size / unit_pressure(fields)) + of_contact
        terms = (
            Term(sign * self.friction, solution.fields, solution.error),
            Term(-sign * self.friction, fields, error),
        )
        stated = own + stated_error(solution, terms[:1], self.friction) + of_contact
        parts = parted(solution, fields.zone_table, stated)
        return replace(
            self._whole(shear, parts.stick, sign * self._creepage_unit * found.amplitudes[0]),
            slip_zones=parts.slip,
            error=stated,
            terms=terms,
        )

    def _whole(self, shear: float, stick: Array, creepage: float | None) -> Slip:
        """The `Slip` if everything sticks or slides; otherwise `_slip` replaces some fields."""
        solution = self.solution
        weight = shear / solution.load
        terms = (Term(weight, solution.fields, solution.error),) if weight else ()
        return Slip(
            solution=solution,
            friction=self.friction,
            tangential_load=shear,
            stick_zones=stick,
            slip_zones=np.zeros((0, 2)) if len(stick) else solution.zones,
            shift=None,
            error=stated_error(solution, terms, self.friction),
            terms=terms,
            model="rolling",
            creepage=None if creepage is None else float(creepage),
        )


def _identity(x: Array) -> Array:
    """The function x, which is the primitive of the constant 1."""
    return np.asarray(x)
