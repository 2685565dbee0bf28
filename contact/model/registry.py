"""Registries of profiles, interactions, substrates, laws and controls by name.

`@register_profile("cosh")` makes a class known to scene files. Classes of other installed packages
come through the entry-point groups `contact.profiles`, `contact.interactions`,
`contact.substrates`, `contact.laws` and `contact.controls`. These classes are loaded at the first
search for a name that is not built in, or when all names are listed. A class that fails to load is
skipped with a warning.
"""

import dataclasses
import inspect
import warnings
from collections.abc import Callable, Mapping
from typing import Any, ClassVar, TypeVar

from contact.errors import SceneError
from contact.extras import entry_points
from contact.model.checks import NamesArguments, of_author

C = TypeVar("C", bound=type)


class Named(NamesArguments):
    """Base class of the parts of a scene (profile, law, ...), which gives each class a `name`.

    The name is the registered one, else the class's own attribute `name`, else the name of the
    class.
    """

    name: ClassVar[str]

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if "name" not in cls.__dict__:
            annotation = str(inspect.get_annotations(cls).get("name", "ClassVar"))
            if "ClassVar" not in annotation:
                allowed = (
                    "given another name: `name` is what scene files and messages call the class"
                )
                raise SceneError.of(f"a field of {cls.__name__}", "name", allowed)
            cls.name = cls.__name__


class Registry:
    """Classes of one kind by name. A class without the methods `must_have` is refused."""

    def __init__(self, kind: str, group: str, must_have: tuple[str, ...] = ()) -> None:
        self.kind = kind
        self.group = group
        self.must_have = must_have
        self._classes: dict[str, Any] = {}
        self._plugins_loaded = False

    def register(self, name: str) -> Callable[[C], C]:
        """Return a class decorator that sets `cls.name` and registers the class under this name."""
        if not isinstance(name, str) or not name.strip():
            raise SceneError.of(f"{self.kind} name", name, "a non-empty string")

        def enter(cls: C) -> C:
            self._enter(name, cls)
            return cls

        return enter

    def _enter(self, name: str, cls: Any) -> None:
        if not isinstance(cls, type):
            raise SceneError.of(f"{self.kind} {name!r}", cls, "a class")
        missing = [m for m in self.must_have if not hasattr(cls, m)]
        if missing:
            raise SceneError.of(f"{self.kind} {name!r}", cls, f"a class with {', '.join(missing)}")
        if name in self._classes:
            raise SceneError.of(
                f"{self.kind} name",
                name,
                f"a new name (this one already belongs to {self._classes[name].__qualname__})",
            )
        cls.name = name  # type: ignore[attr-defined]
        self._classes[name] = cls

    def forget(self, name: str) -> None:
        """Remove a name from the registry, for tests and for running a notebook cell twice."""
        self._classes.pop(name, None)

    def find(self, name: str, key: str | None = None) -> Any:
        """The class registered under a name. For an unknown name, SceneError names the nearest
        known one.

        key: the key of a scene file under which the name was written, for the message.
        """
        if isinstance(name, str) and name not in self._classes:
            self._load_plugins()
        if not isinstance(name, str) or name not in self._classes:
            raise SceneError.unknown(key or self.kind, name, self._classes)
        return self._classes[name]

    def all(self) -> dict[str, Any]:
        """All registered names, each with its class, in alphabetical order."""
        self._load_plugins()
        return dict(sorted(self._classes.items()))

    def _load_plugins(self) -> None:
        if self._plugins_loaded:
            return
        self._plugins_loaded = True
        for point in entry_points(self.group):
            try:
                cls = point.load()
                # Loading a module runs the decorators that register its classes. A class without
                # such a decorator is registered under the name of the entry point.
                if not any(cls is known for known in self._classes.values()):
                    self._enter(point.name, cls)
            except Exception as error:  # a third-party module may raise anything
                skipped = f"{self.kind} {point.name!r} of entry-point group {self.group} is skipped"
                warnings.warn(
                    f"{skipped}: {type(error).__name__}: {error}", RuntimeWarning, stacklevel=3
                )


def construct(cls: Callable[..., Any], what: str, params: Mapping[str, Any]) -> Any:
    """Return `cls(**params)`; SceneError names the unknown or missing parameters."""
    accepted = inspect.signature(cls).parameters.values()
    known = [p.name for p in accepted if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)]
    anything = any(p.kind is p.VAR_KEYWORD for p in accepted)
    for key in params:
        if key not in known and not anything:
            raise SceneError.unknown(f"parameter of {what}", key, known)
    for p in accepted:
        if p.name in known and p.default is p.empty and p.name not in params:
            message = (
                f"{what} needs the parameter {p.name!r}; its parameters are {', '.join(known)}"
            )
            raise SceneError(message, p.name, None, "given")
    return cls(**params)


def parameters(part: Any) -> dict[str, Any]:
    """The arguments, by name, from which the class of `part` makes an equal object.
    `part` is a part of a scene, such as a law.
    """
    return (
        {f.name: getattr(part, f.name) for f in dataclasses.fields(part) if f.init}
        if dataclasses.is_dataclass(part)
        else {}
    )


def anew(kind: Callable[..., Any], arguments: Mapping[str, Any]) -> Any:
    """A new object of the class `kind` from arguments by name.
    SceneError if the class does not take these arguments.
    """
    name = getattr(kind, "__name__", str(kind))
    call = f"{name}({', '.join(f'{key}=...' for key in arguments)})"
    with of_author(
        call,
        name,
        hint="; the class must accept its parameters by name, as a frozen dataclass does",
    ):
        part = kind(**arguments)
    return part


def remade(part: Any, changes: Mapping[str, Any]) -> Any:
    """A copy of a part of a scene (e.g. of a law) in which some parameters have other values."""
    return anew(type(part), {**parameters(part), **changes})


PROFILES = Registry("profile", "contact.profiles", ("height", "from_table"))
INTERACTIONS = Registry("interaction", "contact.interactions")
SUBSTRATES = Registry("substrate", "contact.substrates", ("symbol",))
LAWS = Registry("law", "contact.laws", ("intensity",))
CONTROLS = Registry("control", "contact.controls", ("held", "of"))


def register_profile(name: str) -> Callable[[C], C]:
    """Class decorator that makes a profile known under this name.

    Parameters
    ----------
    name : str
        The name for `contact.profile` and scene files; it must be new.

    Returns
    -------
    callable
        The decorator; it sets the `name` of the class and returns it.

    Raises
    ------
    SceneError
        If the name is taken, or the class has no `height`.

    Examples
    --------
    >>> import contact
    >>> import numpy as np
    >>> from dataclasses import dataclass
    >>> @contact.register_profile("doc-cosh")
    ... @dataclass(frozen=True)
    ... class Cosh(contact.Profile):
    ...     scale: float
    ...     def height(self, x):
    ...         return self.scale * np.cosh(np.asarray(x) / self.scale)
    >>> contact.profile("doc-cosh", scale=2.0) == Cosh(2.0)
    True
    >>> contact.model.registry.PROFILES.forget("doc-cosh")
    """
    return PROFILES.register(name)


def register_interaction(name: str) -> Callable[[C], C]:
    """Class decorator that makes an interaction known under this name.

    Parameters
    ----------
    name : str
        The name for `contact.interaction` and scene files; it must be new.

    Returns
    -------
    callable
        The decorator; it sets the `name` of the class and returns it.

    Raises
    ------
    SceneError
        If the name is taken.

    Examples
    --------
    >>> import contact
    >>> from dataclasses import dataclass
    >>> @contact.register_interaction("doc-alone")
    ... @dataclass(frozen=True)
    ... class Alone(contact.Interaction):
    ...     allows = ("load",)
    >>> contact.interaction("doc-alone") == Alone()
    True
    >>> contact.model.registry.INTERACTIONS.forget("doc-alone")
    """
    return INTERACTIONS.register(name)


def register_substrate(name: str) -> Callable[[C], C]:
    """Class decorator that makes a substrate known under this name.

    Parameters
    ----------
    name : str
        The name for `contact.substrate` and scene files; it must be new.

    Returns
    -------
    callable
        The decorator; it sets the `name` of the class and returns it.

    Raises
    ------
    SceneError
        If the name is taken, or the class has no `symbol`.

    Examples
    --------
    >>> import contact
    >>> import numpy as np
    >>> from dataclasses import dataclass
    >>> @contact.register_substrate("doc-soft")
    ... @dataclass(frozen=True)
    ... class Soft(contact.Substrate):
    ...     depth: float
    ...     def symbol(self, q):
    ...         return 1 + 0.5 * np.exp(-q * self.depth)
    >>> contact.substrate("doc-soft", depth=1e-3) == Soft(1e-3)
    True
    >>> contact.model.registry.SUBSTRATES.forget("doc-soft")
    """
    return SUBSTRATES.register(name)


def register_law(name: str) -> Callable[[C], C]:
    """Class decorator that makes a law known under this name.

    Parameters
    ----------
    name : str
        The name for `contact.law` and scene files; it must be new.

    Returns
    -------
    callable
        The decorator; it sets the `name` of the class and returns it.

    Raises
    ------
    SceneError
        If the name is taken.

    Examples
    --------
    >>> import contact
    >>> from dataclasses import dataclass
    >>> @contact.register_law("doc-sticky")
    ... @dataclass(frozen=True)
    ... class Sticky(contact.Law):
    ...     K: float
    ...     pulls = True
    ...     def intensity(self, E_star):
    ...         return -self.K
    >>> contact.law("doc-sticky", K=1e3) == Sticky(1e3)
    True
    >>> contact.model.registry.LAWS.forget("doc-sticky")
    """
    return LAWS.register(name)


def register_control(name: str) -> Callable[[C], C]:
    """Class decorator that makes a control known under this name.

    Parameters
    ----------
    name : str
        The name for scene files; it must be new.

    Returns
    -------
    callable
        The decorator; it sets the `name` of the class and returns it.

    Raises
    ------
    SceneError
        If the name is taken, or the class is no control.

    Examples
    --------
    >>> import contact
    >>> from dataclasses import dataclass
    >>> @contact.register_control("doc-peak")
    ... @dataclass(frozen=True)
    ... class Peak(contact.Control):
    ...     unit = "Pa"
    ...     def of(self, solution):
    ...         return solution.max_pressure
    >>> scene = contact.Scene(contact.Parabola(1.0), 1e9, contact.Isolated(), given=Peak(1e6))
    >>> round(contact.solve(scene).max_pressure)
    1000000
    >>> contact.model.registry.CONTROLS.forget("doc-peak")
    """
    return CONTROLS.register(name)


def from_table(
    registry: Registry, name: str, params: Mapping[str, Any], key: str | None = None
) -> Any:
    """An object of the class registered under this name, with these parameters. `key` is the key
    of the scene file that gives the name.
    """
    return construct(registry.find(name, key), f"{registry.kind} {name!r}", params)


def profile(name: str, **params: Any) -> Any:
    """The profile of this name with these parameters, as in the table of a scene file.

    Parameters
    ----------
    name : str
        A name of `contact.profiles()`.
    **params
        The arguments of its class.

    Returns
    -------
    Profile

    Raises
    ------
    SceneError
        If the name is unknown, or a parameter is unknown, missing or wrong. The message names the
        nearest known name.

    Examples
    --------
    >>> import contact
    >>> contact.profile("sinusoid", amplitude=1e-6, period=1e-4)
    Sinusoid(amplitude=1e-06, period=0.0001)
    """
    return PROFILES.find(name).from_table(params)


def interaction(name: str, **params: Any) -> Any:
    """The interaction of that name with these parameters.

    Parameters
    ----------
    name : str
        A name of `contact.interactions()`.
    **params
        The arguments of its class.

    Returns
    -------
    Interaction

    Raises
    ------
    SceneError
        If the name is unknown, or a parameter is unknown, missing or wrong. The message names the
        nearest known name.

    Examples
    --------
    >>> import contact
    >>> contact.interaction("localized", closure="self-consistent", neighbours=2)
    Localized(closure='self-consistent', neighbours=2)
    """
    return from_table(INTERACTIONS, name, params)


def substrate(name: str, **params: Any) -> Any:
    """The substrate of that name with these parameters.

    Parameters
    ----------
    name : str
        A name of `contact.substrates()`.
    **params
        The arguments of its class.

    Returns
    -------
    Substrate

    Raises
    ------
    SceneError
        If the name is unknown, or a parameter is unknown, missing or wrong. The message names the
        nearest known name.

    Examples
    --------
    >>> import contact
    >>> contact.substrate("layer", thickness=1e-3, nu=0.3)
    Layer(thickness=0.001, nu=0.3, base='bonded')
    """
    return from_table(SUBSTRATES, name, params)


def law(name: str, **params: Any) -> Any:
    """The law of that name with these parameters.

    Parameters
    ----------
    name : str
        A name of `contact.laws()`.
    **params
        The arguments of its class.

    Returns
    -------
    Law

    Raises
    ------
    SceneError
        If the name is unknown, or a parameter is unknown, missing or wrong. The message names the
        nearest known name.

    Examples
    --------
    >>> import contact
    >>> contact.law("frictionless")
    Frictionless()
    """
    return from_table(LAWS, name, params)


def profiles() -> dict[str, Any]:
    """All known profiles: a mapping from the name to the class.

    Returns
    -------
    dict
        In alphabetical order, including the classes of installed packages.

    Examples
    --------
    >>> import contact
    >>> contact.profiles()["wedge"] is contact.Wedge
    True
    """
    return PROFILES.all()


def interactions() -> dict[str, Any]:
    """All known interactions: a mapping from the name to the class.

    Returns
    -------
    dict
        In alphabetical order, including the classes of installed packages.

    Examples
    --------
    >>> import contact
    >>> contact.interactions()["periodic"] is contact.Periodic
    True
    """
    return INTERACTIONS.all()


def substrates() -> dict[str, Any]:
    """All known substrates: a mapping from the name to the class.

    Returns
    -------
    dict
        In alphabetical order, including the classes of installed packages.

    Examples
    --------
    >>> import contact
    >>> contact.substrates()["half-plane"] is contact.HalfPlane
    True
    """
    return SUBSTRATES.all()


def laws() -> dict[str, Any]:
    """All known laws: a mapping from the name to the class.

    Returns
    -------
    dict
        In alphabetical order, including the classes of installed packages.

    Examples
    --------
    >>> import contact
    >>> contact.laws()["frictionless"] is contact.Frictionless
    True
    """
    return LAWS.all()


def controls() -> dict[str, Any]:
    """All known controls: a mapping from the name to the class.

    Returns
    -------
    dict
        In alphabetical order, including the classes of installed packages.

    Examples
    --------
    >>> import contact
    >>> contact.controls()["mean_pressure"].unit
    'Pa'
    """
    return CONTROLS.all()
