"""A contact scene: a profile, a material, an interaction, a substrate, a law and one control.

The material enters only through the reduced modulus, equation (2) of Goryacheva & Tsukanov (2020),

    1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.

The control is the one quantity that is given: load [N/m], mean pressure [Pa], approach [m], half
width [m] or contact fraction [1]. An isolated body may also be turned. A given `tilt` [rad] makes
the gap at zero load f(x) - tilt x; a given `moment` of the pressure, int p x dx [N], makes the tilt
an unknown. Units are SI. Everything is checked when the scene is made, so that the solver need not
check it again.
"""

from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property

import numpy as np

import sie
from contact.errors import SceneError
from contact.model.checks import (
    NamesArguments,
    both_or_neither,
    finite,
    finite_or_none,
    keep,
    poisson_ratio,
    positive,
)
from contact.model.controls import CONTROLS, TURNING, Control, Quantity, fields_under
from contact.model.interactions.base import Interaction
from contact.model.laws import Frictionless, Law
from contact.model.operator import Operator
from contact.model.plugin_checks.declarations import require_declared
from contact.model.plugin_checks.forms import (
    AuthorMethod,
    held_by,
    is_own,
    require_attributes,
    require_calls,
    require_conjugate,
    require_form,
    require_law,
)
from contact.model.plugin_checks.operators import require_body, require_elastic
from contact.model.profiles.base import Profile
from contact.model.registry import CONTROLS as REGISTERED
from contact.model.registry import remade
from contact.model.substrates import HalfPlane, Substrate

# Methods that a user's control or law defines and that this module calls.
_SIGNED = AuthorMethod("control.signed(scene)", "control")
_CHECK = AuthorMethod("control.check(scene)", "control")
_REFUSES = AuthorMethod("law.refuses(scene)", "law")


def E_star(E1: float, nu1: float, E2: float | None = None, nu2: float | None = None) -> float:
    """The reduced modulus E* [Pa] of two bodies; without E2 and nu2 the counter-body is rigid.

    Parameters
    ----------
    E1, E2 : float
        Young's moduli [Pa]; E2 None: a rigid counter-body.
    nu1, nu2 : float
        Poisson's ratios [1], above -1 and at most 0.5; nu2 is given with E2.

    Returns
    -------
    float
        E* [Pa], 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.

    Raises
    ------
    SceneError
        If a modulus is not positive, a ratio out of range, or one of E2, nu2 is given without the
        other.

    Examples
    --------
    >>> import contact
    >>> round(contact.E_star(210e9, 0.3, 210e9, 0.3) / 1e9, 3)
    115.385
    """
    compliance = _plane_compliance("E1", E1, "nu1", nu1)
    both_or_neither(E2, nu2)
    if E2 is not None and nu2 is not None:
        compliance += _plane_compliance("E2", E2, "nu2", nu2)
    return positive("E_star", 1.0 / compliance)


def _plane_compliance(modulus_name: str, modulus: float, ratio_name: str, ratio: float) -> float:
    """The compliance (1 - nu^2)/E of one body in plane strain."""
    modulus = positive(modulus_name, modulus)
    return (1.0 - poisson_ratio(ratio_name, ratio) ** 2) / modulus


@dataclass(frozen=True)
class Scene(NamesArguments, sie.Kept):
    """A complete contact problem. Exactly one control is given; the other controls are None.

    All is checked when the scene is made. Units are SI, loads per unit thickness.

    Parameters
    ----------
    profile : Profile
        The shape: the gap at zero load.
    E_star : float
        Reduced modulus [Pa], see `contact.E_star`.
    interaction : Interaction
        How the rest of the surface acts: `Isolated()`, `Periodic()`, `Localized()` or one of your
        own.
    substrate : Substrate
        The elastic body, a half-plane if left out.
    law : Law
        What happens at the interface, frictionless if left out.
    load : float or None
        Control: load [N/m]; in a periodic contact, the load on one period.
    mean_pressure : float or None
        Control: mean pressure [Pa], the load divided by the profile's period.
    approach : float or None
        Control: approach of the bodies [m]; without a period, it needs a datum or a body with a
        base.
    half_width : float or None
        Control: half width [m] of the one zone of a symmetric profile.
    contact_fraction : float or None
        Control: contact fraction [1], the width in contact divided by the period, above 0 and at
        most 1.
    given : Control or None
        Another control, such as one of your own (`contact.Control`).
    tilt : float or None
        Angle [rad] by which the body is turned: the gap at zero load is f(x) - tilt x. If the tilt
        is positive, the side x > 0 comes down.
    moment : float or None
        int p x dx about x = 0 [N], positive where more of the load is at x > 0; the tilt is then
        unknown. At most one of tilt and moment, and only under a model that lets the body turn
        (`Isolated`); without either the tilt is 0.

    Raises
    ------
    SceneError
        If anything given is not what it must be, or the parts do not go together; the message names
        the field.

    Examples
    --------
    >>> import contact
    >>> wave = contact.Sinusoid(1e-6, 1e-4)
    >>> scene = contact.Scene(
    ...     wave, E_star=1.1e11, interaction=contact.Periodic(), mean_pressure=1.7e9
    ... )
    >>> scene.control, round(scene.given_load)
    (('mean_pressure', 1700000000.0), 170000)
    """

    profile: Profile
    E_star: float
    interaction: Interaction
    _: KW_ONLY
    substrate: Substrate = HalfPlane()
    law: Law = Frictionless()
    load: float | None = None
    mean_pressure: float | None = None
    approach: float | None = None
    half_width: float | None = None
    contact_fraction: float | None = None
    given: Control | None = None
    tilt: float | None = None
    moment: float | None = None

    def __post_init__(self) -> None:
        _require_instance("profile", self.profile, Profile, "Sinusoid(amplitude=1e-6, period=1e-4)")
        for body in self.profile.bodies.values():
            if is_own(body):
                require_calls(Profile, body)
                require_declared(body)
                require_attributes(Profile, body)
                require_conjugate(body)
        _require_instance("interaction", self.interaction, Interaction, "Periodic()")
        _require_instance("substrate", self.substrate, Substrate, "HalfPlane()")
        _require_instance("law", self.law, Law, "Frictionless()")
        for kind, part in (
            (Interaction, self.interaction),
            (Substrate, self.substrate),
            (Law, self.law),
        ):
            require_form(kind, part)
        if self.interaction.strip and not self.interaction.needs_period:
            raise SceneError.of(
                "interaction.needs_period",
                self.interaction.needs_period,
                "True, since a strip is one period of the profile",
            )
        keep(self, positive, "E_star")
        keep(self, finite_or_none, *TURNING)
        if self.interaction.needs_period and self.profile.period is None:
            raise SceneError.of(
                "interaction",
                self.interaction.name,
                f"a model without a period, since {self.profile.no_period}",
            )
        self._check_body()
        self._check_turning()
        self._check_control()

    def _check_control(self) -> None:
        """Check that exactly one control is given, and that its value suits the rest of the
        scene.
        """
        given = tuple(name for name in (*CONTROLS, "given") if getattr(self, name) is not None)
        if len(given) != 1:
            raise SceneError.of("control", given or None, f"exactly one of {', '.join(CONTROLS)}")
        if self.given is not None:
            _require_instance("given", self.given, Control, "one of your own")
            require_form(Control, self.given)
            if is_own(self.given) and self.given.name in CONTROLS:
                raise SceneError.of(
                    "control.name",
                    self.given.name,
                    "another name: the package has a control of this name",
                )
        control = self.control_object
        name = control.name
        signed = _SIGNED.value(control.signed, self)
        value = finite(name, control.value) if signed else positive(name, control.value)
        control = (
            remade(control, {"value": value}) if is_own(control) else replace(control, value=value)
        )
        object.__setattr__(self, *(("given", control) if self.given is not None else (name, value)))
        self.__dict__["control_object"] = control

        named = control if name in CONTROLS else self._named(control)
        self._check_admitted(control, "load" if named is None else named.name)
        _CHECK.value(control.check, self)
        if named is not None and named is not control:
            named.check(self)
        self._check_law()
        if self.interaction.follows_isolated and self.is_flat:
            # In this closure, the nominal pressure comes from an isolated contact that is as wide
            # as the zones. Under a flat punch, every isolated contact has the width of the punch,
            # so that its load is not determined.
            allowed = (
                "another model or closure: under a flat profile, an isolated contact has the "
                "same width at every load"
            )
            raise SceneError.of("interaction", self.interaction, allowed)

    def under(self, name: str, value: float) -> "Scene":
        """The scene with another value of a control, or with another control. Only the control is
        checked again.
        """
        other = object.__new__(type(self))
        other.__dict__.update({**self.__dict__, **fields_under(name, value, self.given)})
        other.__dict__.pop("control_object", None)
        other._check_control()
        return other

    @property
    def control(self) -> tuple[str, float]:
        """Name and value of the quantity that the scene prescribes, such as the load."""
        return self.control_object.name, self.control_object.value

    @cached_property
    def control_object(self) -> Control:
        """The control of the scene as an object."""
        if self.given is not None:
            return self.given
        name = next(name for name in CONTROLS if getattr(self, name) is not None)
        return REGISTERED.find(name)(getattr(self, name))

    def held(self, quantity: Quantity) -> float | None:
        """The SI value that the control prescribes for `quantity`.
        None if the solver does not prescribe this quantity directly.
        """
        held = self.control_object.held(self)
        return held.value if held is not None and held.quantity is quantity else None

    @property
    def given_load(self) -> float | None:
        """The load [N/m] that the control prescribes, directly or as a mean pressure. It is None if
        the control prescribes another quantity.
        """
        return self.held(Quantity.LOAD)

    @property
    def given_fraction(self) -> float | None:
        """The contact fraction that the control prescribes, directly or as a width. It is None if
        the control prescribes another quantity.
        """
        width, period = self.held(Quantity.WIDTH), self.profile.period
        if width is None or period is None:
            return None
        return width / period if self.contact_fraction is None else self.contact_fraction

    @property
    def turning(self) -> dict[str, float]:
        """The given `tilt` [rad] or `moment` [N], by name; empty if neither is given."""
        return {name: value for name in TURNING if (value := getattr(self, name)) is not None}

    @property
    def turned(self) -> bool:
        """Whether the body may be tilted, by a given angle or by an unknown one.

        A zero moment does not turn a symmetric body.
        """
        if self.moment is not None:
            return self.moment != 0.0 or not self.profile.symmetric
        return self.tilt is not None and self.tilt != 0.0

    @property
    def period(self) -> float | None:
        """The period of the solution; None for a contact that does not repeat, such as one cell
        alone.
        """
        return self.profile.period if self.interaction.needs_period else None

    @cached_property
    def operator(self) -> Operator:
        """The elastic operator, which maps a pressure to the displacement of the surface."""
        return Operator(self.interaction, self.substrate, self.period)

    def _check_admitted(self, control: Control, asked: str) -> None:
        """Raise SceneError if the interaction or the law does not admit the control.

        asked: the name of the prescribed quantity.
        """
        for part in (self.interaction, self.law):
            if asked not in part.allows:
                allowed = (
                    f"left out: {part.name} accepts only the controls {', '.join(part.allows)}"
                )
                raise SceneError.of(control.name, control.value, allowed)
        if control.name not in CONTROLS and not self.law.equilibria.unique:
            raise SceneError.of(
                control.name,
                control.value,
                f"left out: under {self.law.name} a load may have several contacts, but your own "
                "control needs one contact for each load",
            )

    def _named(self, control: Control) -> Control | None:
        """The built-in control for the quantity that a user's control prescribes.
        None if there is no such built-in control, as for a width without a period.
        """
        held, period = held_by(control, self), self.profile.period
        if held is None or (held.quantity is Quantity.WIDTH and period is None):
            return None
        name, value = held.quantity.name.lower(), held.value
        if held.quantity is Quantity.WIDTH and period is not None:
            name, value = "contact_fraction", value / period
        named: Control = REGISTERED.find(name)(value)
        (finite if named.signed(self) else positive)(f"{control.name}, which holds {name}", value)
        return named

    def _check_body(self) -> None:
        """Check the substrate, the interaction, and whether the two can be used together."""
        model, body = self.interaction, self.substrate
        if is_own(body):
            require_body(body)
        operator = self.operator
        if operator.is_own:
            if not isinstance(body, HalfPlane):
                allowed = (
                    f"left out: {model.name} has its own kernel, which does not depend on the "
                    "substrate"
                )
                raise SceneError.of("substrate", body.name, allowed)
            if is_own(model):
                ends, resolution = self.profile.support, self.profile.resolution
                require_elastic(
                    operator,
                    resolution or (ends[1] - ends[0] if ends else self.profile.period or 1.0),
                )
        elif body.compression is not None and model.datum is not None:
            allowed = (
                f"left out: displacements of the {body.name} substrate are measured from its base"
            )
            raise SceneError.of("interaction.datum", model.datum, allowed)
        if operator.is_periodic and operator.symbol is not None:
            # The attribute `excess` is computed here because this also checks the symbol at the
            # harmonics of the period.
            assert operator.excess is not None

    def _check_law(self) -> None:
        law = self.law
        if not law.turns and self.turned:
            ((turning, value),) = self.turning.items()
            raise SceneError.of(
                turning, value, f"left out: {law.name} is solved only for bodies that do not tilt"
            )
        require_law(law, self.E_star)
        why = _REFUSES.text(law.refuses, self)
        if why:
            raise SceneError.of("law", law.name, f"one that fits the scene: {law.name} {why}")

    def _check_turning(self) -> None:
        if len(self.turning) > 1:
            raise SceneError.of(
                " and ".join(TURNING),
                tuple(self.turning.values()),
                "only one of the two: the other is part of the solution",
            )
        if self.turning and not self.interaction.turns:
            ((turning, value),) = self.turning.items()
            raise SceneError.of(
                turning,
                value,
                f"left out: in the model {self.interaction.name} the body cannot tilt",
            )

    @property
    def is_flat(self) -> bool:
        """Whether the profile is a punch with sharp corners and no slope between them."""
        return self.profile.support is not None and self.is_flat_between(*self.profile.support)

    def is_flat_between(self, lo: float, hi: float) -> bool:
        """Whether the profile is flat (f' = 0) in an interval. Every load then gives the same
        zone.
        """
        height = self.profile.height(np.linspace(lo, hi, 17))
        return float(np.ptp(height[np.isfinite(height)])) == 0.0


def _require_instance(field: str, value: object, kind: type, example: str) -> None:
    if isinstance(value, kind):
        return
    shown = value.__name__ if isinstance(value, type) else value
    if isinstance(value, type) and issubclass(value, kind):
        raise SceneError.of(field, shown, f"an object, not its class: write {shown}(...)")
    raise SceneError.of(field, shown, f"a contact.{kind.__name__}, such as {example}")
