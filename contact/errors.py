"""What can go wrong, by name: every error of the package is a ContactError.

Bad input is a SceneError that names the field, the value and what is allowed; a run that does not
reach its tolerance is a NotConverged that carries its best state; a load or approach no zone can
carry is OutOfRange. What is solved all the same, though the model hardly covers it, is a
ModelWarning.
"""

import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from typing import Any, ClassVar

import numpy as np

_LONGEST_VALUE = 80


class ContactError(Exception):
    """Base of every error the package raises on purpose.

    Examples
    --------
    >>> import contact
    >>> try:
    ...     contact.Sinusoid(amplitude=-1.0, period=1.0)
    ... except contact.ContactError as error:
    ...     print(error)
    amplitude = -1.0 is refused: it must be a finite number > 0
    """

    # A longer message loses its middle. What a terminal shows in five lines.
    longest: ClassVar[int] = 400

    def __str__(self) -> str:
        """The message, at most `longest` characters of it."""
        return _cut(super().__str__(), self.longest)


class SceneError(ContactError, ValueError):
    """Bad input; `field`, `value` and `allowed` are None where the message is about more than one
    field.

    Parameters
    ----------
    message : str
        What is wrong, in one line.
    field : str or None
        The name of what was given.
    value : object
        What was given.
    allowed : str or None
        What is allowed, in words.

    Examples
    --------
    >>> import contact
    >>> try:
    ...     contact.profile("sinusiod", amplitude=1e-6, period=1e-4)
    ... except contact.SceneError as error:
    ...     print(error.field, error.value)
    profile sinusiod
    """

    def __init__(
        self, message: str, field: str | None = None, value: Any = None, allowed: str | None = None
    ) -> None:
        super().__init__(message)
        self.field = field
        self.value = value
        self.allowed = allowed

    @classmethod
    def of(cls, field: str, value: Any, allowed: str) -> "SceneError":
        """The usual message: the field, its value, what is allowed."""
        return cls(
            f"{field} = {shown(value)} is refused: it must be {allowed}", field, value, allowed
        )

    @classmethod
    def unknown(cls, what: str, name: Any, known: Iterable[str]) -> "SceneError":
        """A name that is not among the known ones, with the nearest of them."""
        names = sorted(known)
        near = get_close_matches(name, names, n=1) if isinstance(name, str) else []
        hint = f" (did you mean {near[0]!r}?)" if near else ""
        allowed = f"one of {', '.join(names) if names else '(none)'}"
        return cls(
            f"{what} = {shown(name)} is not known{hint}: it must be {allowed}", what, name, allowed
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.field, self.value, self.allowed)


class NotConverged(ContactError):
    """The tolerance was not met: `trace` is the list of steps, `best` the best solution reached or
    None.

    Parameters
    ----------
    message : str
        Why the search stopped, in one line.
    trace : iterable
        The steps of the search, kept as a list.
    best : Solution or None
        The best state that was reached, with its own stated error.

    Examples
    --------
    >>> import contact
    >>> error = contact.NotConverged("the ends do not come to rest")
    >>> error.trace, error.best
    ([], None)
    """

    def __init__(self, message: str, trace: Iterable[Any] = (), best: Any = None) -> None:
        super().__init__(message)
        self.trace = list(trace)
        self.best = best

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.trace, self.best)


class OutOfRange(ContactError):
    """No contact answers the control: a load past full contact, an approach or zone past its limit.

    Examples
    --------
    >>> import contact
    >>> lone = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Isolated(), load=1e9)
    >>> try:
    ...     contact.solve(lone)
    ... except contact.OutOfRange as error:
    ...     print("refused")
    refused
    """


class MissingExtra(ContactError, ImportError):
    """An optional package is needed that is not installed; the message names the extra that brings
    it.

    Examples
    --------
    >>> import contact
    >>> issubclass(contact.MissingExtra, ImportError)
    True
    """


class ModelWarning(UserWarning):
    """The model hardly covers what is asked of it, or a file's numbers are not those of a surface.

    Examples
    --------
    >>> import contact, warnings
    >>> steep = contact.Scene(contact.Sinusoid(0.1, 1.0), 1e9, contact.Periodic(), contact_fraction=0.1)
    >>> with warnings.catch_warnings(record=True) as given:
    ...     warnings.simplefilter("always")
    ...     solution = contact.solve(steep)
    >>> len(given) == len(solution.warnings) > 0
    True
    """


def warn(messages: Iterable[str], stacklevel: int = 3) -> None:
    """Give out each message as a ModelWarning of the line that called the caller."""
    for message in messages:
        warnings.warn(_cut(message, ContactError.longest), ModelWarning, stacklevel=stacklevel)


@contextmanager
def unwarned() -> Iterator[None]:
    """Without ModelWarnings: of solutions on the way to another one, which has its own."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)
        yield


def shown(value: Any) -> str:
    """A value as it stands in a message: on one line, of an array its first and last numbers, the
    middle of a long text left out (a path's end names the file).
    """
    if isinstance(value, np.ndarray):
        text = np.array2string(value, separator=", ", threshold=8, edgeitems=3)
    else:
        # Numbers of numpy as plain ones, in lists too.
        with np.printoptions(legacy="1.25"):
            text = repr(value)
    return _cut(" ".join(text.split()), _LONGEST_VALUE)


def _cut(text: str, longest: int) -> str:
    """A text with its middle left out where it is longer than that."""
    if len(text) <= longest:
        return text
    kept = longest - 3
    return text[: kept // 2] + "..." + text[kept // 2 - kept :]
