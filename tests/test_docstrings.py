"""Docstrings of exported names list all parameters, the result, and an example that runs."""

from __future__ import annotations

import doctest
import inspect
import re
from typing import Any

import pytest

import contact
import contact.testing
import sie
from contact import axisymmetric
from contact.reference import exact, inverse

NAMES = {
    f"{package.__name__}.{name}": getattr(package, name)
    for package in (contact, sie, exact, inverse, axisymmetric)
    for name in package.__all__
    if inspect.isclass(getattr(package, name)) or inspect.isfunction(getattr(package, name))
} | {
    f"contact.testing.{name}": getattr(contact.testing, name)
    for name in ("check_profile", "check_substrate")
}
HEADINGS = ("Parameters", "Attributes", "Returns", "Raises", "Warns", "Examples")


def sections(text: str) -> dict[str, str]:
    """The text below each heading."""
    parts = re.split(rf"^({'|'.join(HEADINGS)})\n-+\n", inspect.cleandoc(text), flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def told(section: str) -> set[str]:
    """Names before the colon of a line such as `x, y : float`."""
    heads = re.findall(r"^(\*{0,2}\w[\w, *]*?)(?: :.*)?$", section, re.MULTILINE)
    return {name.strip().lstrip("*") for head in heads for name in head.split(",")}


def taken(thing: Any) -> set[str]:
    """Names of the parameters of a function, or of a class of which users make objects."""
    if getattr(thing, "_is_protocol", False):  # no object of it is made
        return set()
    try:
        return {name for name in inspect.signature(thing).parameters if not name.startswith("_")}
    except ValueError:  # an exception without parameters of its own
        return set()


def failures(name: str, thing: Any) -> int:
    """The number of failed examples in a docstring, or -1 if it has no examples."""
    (found,) = doctest.DocTestFinder(recurse=False).find(thing, name, globs={})
    return (
        doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(found).failed
        if found.examples
        else -1
    )


@pytest.mark.parametrize("name", NAMES)
def test_an_exported_name_has_an_example_that_runs(name: str) -> None:
    assert "__doc__" in vars(NAMES[name]) or inspect.isfunction(NAMES[name])
    assert failures(name, NAMES[name]) == 0


@pytest.mark.parametrize("name", NAMES)
def test_an_exported_name_says_what_it_takes_and_returns(name: str) -> None:
    thing = NAMES[name]
    said = sections(thing.__doc__)
    assert list(said) == sorted(said, key=HEADINGS.index)
    about = told(said.get("Parameters", "")) | told(said.get("Attributes", ""))
    assert taken(thing) <= about, taken(thing) - about
    assert not inspect.isfunction(thing) or said["Returns"].strip()


def test_an_example_that_says_something_wrong_is_noticed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    def wrong() -> None:
        """
        >>> 1 + 1
        3
        """

    assert failures("wrong", wrong) == 1
    assert told("x, y : float\n    A number.\n**rest\n") == {"x", "y", "rest"}
