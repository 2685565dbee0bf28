"""The errors of the package: each is a ContactError.

Bad input is a SceneError with the field, the value and what is allowed. A run that misses its
tolerance is a NotConverged with the best state. A load or an approach without a contact is
OutOfRange. Where the model is doubtful but the scene is solved, there is a ModelWarning.
"""

import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from typing import Any, ClassVar

import numpy as np


class ContactError(Exception):
    """Base class of all errors that the package raises on purpose.

    Examples
    --------
    >>> import contact
    >>> try:
    ...     contact.Sinusoid(amplitude=-1.0, period=1.0)
    ... except contact.ContactError as error:
    ...     print(error)
    amplitude = -1.0 is refused: it must be a finite number > 0
    """

    # Largest length of a message [characters], about five lines on a terminal. Longer messages are
    # shortened in the middle.
    longest: ClassVar[int] = 400
    longest_value: ClassVar[int] = 80  # longest text of a value within a message

    def __str__(self) -> str:
        """The message of the error, shortened to `longest` characters."""
        return _cut(super().__str__(), self.longest)


class SceneError(ContactError, ValueError):
    """Error for bad input; it names the field, the field's value and the allowed values.

    `field`, `value` and `allowed` are None if the message is about more than one field.

    Parameters
    ----------
    message : str
        The message, in one line.
    field : str or None
        The name of the wrong parameter.
    value : object
        The wrong value.
    allowed : str or None
        The allowed values, in words.

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
        """An error whose message has the usual form: the field, its value, and what is allowed."""
        return cls(
            f"{field} = {shown(value)} is refused: it must be {allowed}", field, value, allowed
        )

    @classmethod
    def unknown(cls, what: str, name: Any, known: Iterable[str]) -> "SceneError":
        """An error for an unknown name; the message suggests the most similar known name."""
        names = sorted(known)
        near = get_close_matches(name, names, n=1) if isinstance(name, str) else []
        hint = f" (did you mean {near[0]!r}?)" if near else ""
        allowed = f"one of {', '.join(names) if names else '(none)'}"
        return cls(
            f"{what} = {shown(name)} is not known{hint}: it must be {allowed}", what, name, allowed
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.field, self.value, self.allowed)


class UnknownArgument(SceneError, TypeError):
    """Error for an argument that a class does not have; a TypeError, like Python's own error."""


class NotConverged(ContactError):
    """Error if the tolerance was not met; `trace` holds the steps, `best` the best solution.

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
    """Error if no contact has the given value of the control, as for a load that is too large.

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
    """Error if an optional package is missing; the message names the extra that installs it.

    Examples
    --------
    >>> import contact
    >>> issubclass(contact.MissingExtra, ImportError)
    True
    """


class ModelWarning(UserWarning):
    """Warning of a doubtful model, or of numbers in a file that may not be those of a surface.

    Examples
    --------
    >>> import contact, warnings
    >>> wave = contact.Sinusoid(0.1, 1.0)
    >>> steep = contact.Scene(wave, 1e9, contact.Periodic(), contact_fraction=0.1)
    >>> with warnings.catch_warnings(record=True) as given:
    ...     warnings.simplefilter("always")
    ...     solution = contact.solve(steep)
    >>> len(given) == len(solution.warnings) > 0
    True
    """


def warn(messages: Iterable[str], stacklevel: int = 3) -> None:
    """Issue each message as a ModelWarning at the line that called the caller of `warn`."""
    for message in messages:
        warnings.warn(_cut(message, ContactError.longest), ModelWarning, stacklevel=stacklevel)


@contextmanager
def unwarned() -> Iterator[None]:
    """Context in which no ModelWarning is issued; it is used for intermediate solutions."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)
        yield


def shown(value: Any) -> str:
    """A value as it appears in a message: one line, with the middle of long values left out.

    Arrays show their first and last numbers. The end of a path, which names the file, is kept.
    """
    if isinstance(value, np.ndarray) and not isinstance(value, np.ma.MaskedArray):
        text = np.array2string(value, separator=", ", threshold=8, edgeitems=3)
    else:
        # With this option, numbers of numpy types print like Python numbers, also inside lists.
        with np.printoptions(legacy="1.25"):
            text = repr(value)
    return _cut(" ".join(text.split()), ContactError.longest_value)


def _cut(text: str, longest: int) -> str:
    """A text, without its middle part if the text is longer than `longest`."""
    if len(text) <= longest:
        return text
    kept = longest - 3
    return text[: kept // 2] + "..." + text[kept // 2 - kept :]
