"""Registries of profiles and interactions: names, nearest names, parameters, plug-ins."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest

import contact
from contact import SceneError
from contact.model import registry
from contact.model.registry import Registry


@pytest.fixture
def fresh(monkeypatch: pytest.MonkeyPatch) -> Registry:
    monkeypatch.setattr(registry, "entry_points", lambda group: [])
    return Registry("profile", "contact.profiles", ("height", "from_table"))


@pytest.fixture
def cosh() -> Iterator[type[contact.Profile]]:
    @contact.register_profile("test-cosh")
    @dataclass(frozen=True)
    class Cosh(contact.Profile):
        scale: float

        def height(self, x):  # type: ignore[no-untyped-def]
            return np.cosh(np.asarray(x) / self.scale)

    yield Cosh
    registry.PROFILES.forget("test-cosh")


class Point:
    """A stand-in for an entry point; its method `load` returns or raises the object `gives`."""

    def __init__(self, name: str, gives: object) -> None:
        self.name, self.gives = name, gives

    def load(self) -> object:
        if isinstance(self.gives, Exception):
            raise self.gives
        return self.gives


def test_every_built_in_profile_is_listed() -> None:
    built_in = {
        "biquadratic",
        "flat",
        "fourier",
        "parabola",
        "polynomial",
        "sampled",
        "sinusoid",
        "wedge",
    }
    assert built_in <= set(contact.profiles())
    assert all(cls.name == name for name, cls in contact.profiles().items())


def test_every_built_in_interaction_is_listed() -> None:
    assert {"isolated", "localized", "periodic"} <= set(contact.interactions())


def test_a_registered_profile_is_made_by_name(cosh: type[contact.Profile]) -> None:
    assert contact.profile("test-cosh", scale=2.0) == cosh(2.0)  # type: ignore[call-arg]
    assert cosh.name == "test-cosh"


def test_an_unknown_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(SceneError, match="did you mean 'sinusoid'"):
        contact.profile("sinusiod", amplitude=1.0, period=1.0)
    with pytest.raises(SceneError, match="did you mean 'periodic'"):
        contact.interaction("periodical")


@pytest.mark.parametrize("name", [None, 3, "", ["wedge"]])
def test_an_invalid_name_is_refused(name) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(SceneError):
        contact.profile(name)


def test_unknown_and_missing_parameters_are_named() -> None:
    with pytest.raises(SceneError, match="did you mean 'amplitude'"):
        contact.profile("sinusoid", amplitud=1.0, period=1.0)
    with pytest.raises(SceneError, match="needs the parameter 'period'"):
        contact.profile("sinusoid", amplitude=1.0)
    with pytest.raises(SceneError, match="did you mean 'closure'"):
        contact.interaction("localized", closur="first-order")


def test_a_name_taken_twice_is_refused(cosh: type[contact.Profile]) -> None:
    with pytest.raises(SceneError, match="already belongs to"):
        contact.register_profile("test-cosh")(cosh)


def test_a_class_without_a_height_is_refused(fresh: Registry) -> None:
    with pytest.raises(SceneError, match="height"):
        fresh.register("empty")(type("Empty", (), {}))
    with pytest.raises(SceneError, match="a class"):
        fresh.register("number")(3)  # type: ignore[type-var]
    with pytest.raises(SceneError, match="non-empty"):
        fresh.register("")


def test_installed_profiles_are_loaded_when_first_asked_for(
    fresh: Registry, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []

    class Installed(contact.Profile):
        pass

    def points(group: str) -> list[Point]:
        asked.append(group)
        return [Point("installed", Installed)]

    monkeypatch.setattr(registry, "entry_points", points)
    fresh.register("own")(type("Own", (contact.Profile,), {}))
    fresh.find("own")
    assert asked == []
    assert fresh.find("installed") is Installed and Installed.name == "installed"
    fresh.all()
    assert asked == ["contact.profiles"]


@pytest.mark.parametrize("broken", [ImportError("no such thing"), RuntimeError("boom"), 3])
def test_a_broken_installed_profile_is_reported_and_skipped(
    fresh: Registry, monkeypatch: pytest.MonkeyPatch, broken: object
) -> None:
    good = type("Good", (contact.Profile,), {})
    monkeypatch.setattr(
        registry, "entry_points", lambda group: [Point("bad", broken), Point("good", good)]
    )
    with pytest.warns(RuntimeWarning, match="'bad'.*is skipped"):
        assert list(fresh.all()) == ["good"]
