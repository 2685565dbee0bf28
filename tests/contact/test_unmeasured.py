"""A load on tapered ends, filled dropouts or closing pieces of a trace causes a warning,
whichever way the scene is solved.
"""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import numpy as np
import pytest

import contact
from contact.model.traces.unmeasured import Kind
from contact.solution.preparation import preparation_warnings, shares
from tests.tiers import quick

N, PITCH = 401, 1e-6
LENGTH = (N - 1) * PITCH
X = PITCH * np.arange(N)
ISOLATED, PERIODIC = contact.Isolated(datum=1.0), contact.Periodic()
E_STAR = 1e11


def surface(crest: float, seed: int = 0) -> np.ndarray:
    """Returns heights: waves of 1 to 10 nm, and a crest of 100 nm at the fraction `crest` of the
    length.
    """
    rng = np.random.default_rng(seed)
    waves = sum(
        rng.normal() * np.cos(2 * np.pi * (k * X / LENGTH + rng.random())) / k for k in range(1, 30)
    )
    distance = np.abs(X / LENGTH - crest)
    return 5e-9 * np.asarray(waves) + 1e-7 * np.exp(
        -((np.minimum(distance, 1 - distance) / 0.05) ** 2)
    )


def trace(folder: Path, crest: float, lost: slice | None = None, **keys: object) -> contact.Sampled:
    told = [f"{z:.6e}" for z in surface(crest)]
    if lost is not None:
        told[lost] = ["nan"] * len(told[lost])
    path = folder / "trace.csv"
    path.write_text(
        "x [m];z [m]\n" + "".join(f"{x:.7e};{z}\n" for x, z in zip(X, told, strict=True))
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return contact.read_trace(path, **keys)


def with_crest_in(kind: Kind, folder: Path) -> contact.Sampled:
    """Returns a trace with a period, whose crest lies in an unmeasured interval of the given
    kind.
    """
    if kind is Kind.TAPERED:
        return trace(folder, 0.08, taper=0.2, period=True)
    if kind is Kind.JOINED:
        return trace(folder, 0.0, period=LENGTH + 20 * PITCH)
    fill = "linear" if kind is Kind.FILLED else "drop"
    return trace(folder, 0.5, slice(195, 206), fill=fill, taper=0.01, period=True)


def scene(
    profile: contact.Profile, interaction: contact.Interaction = PERIODIC, **keys: object
) -> contact.Scene:
    return contact.Scene(profile, E_STAR, interaction, **keys)  # type: ignore[arg-type]


ROUTES = {
    "zones": lambda profile: scene(profile, contact_fraction=0.05),
    "load": lambda profile: scene(profile, mean_pressure=1e6),
    "gaps": lambda profile: scene(profile, contact_fraction=0.97),
    "full": lambda profile: scene(profile, contact_fraction=1.0),
    "isolated": lambda profile: scene(profile, ISOLATED, load=200.0),
    "tilted": lambda profile: scene(profile, contact.Isolated(), load=200.0, tilt=1e-5),
    "localized": lambda profile: scene(profile, contact.Localized(), load=200.0),
    "layer": lambda profile: scene(profile, substrate=contact.Layer(1e-4, 0.3), contact_fraction=0.05),
    "jkr": lambda profile: scene(profile, law=contact.JKR(1e-4), load=200.0),
    "dugdale": lambda profile: scene(profile, law=contact.Dugdale(1e-4, 1e6), load=200.0),
    "counter": lambda profile: scene(
        contact.Combined(contact.Sinusoid(1e-10, profile.period), profile, shift=3e-5), contact_fraction=0.05
    ),
    "mirrored": lambda profile: scene(
        contact.Combined(contact.Sinusoid(1e-10, profile.period), profile, shift=3e-5, mirrored=True), contact_fraction=0.05
    ),
}  # fmt: skip


def integrated(solution: contact.Solution, kind: Kind) -> float:
    """Returns the share of the load in the intervals of a kind, as a sum of the pressure at
    evenly spaced positions.
    """
    profile = solution.scene.profile
    place = "counter" if "counter" in profile.bodies else "profile"
    body = profile.bodies[place]
    x = profile.x0 + body.period * (np.arange(200_000) + 0.5) / 200_000
    pressure = np.abs(solution.pressure(x)) * (
        solution.pressure(x) > 0 if solution.scene.law.tension else 1
    )
    own = body.wrap(profile.facing(x)[place])
    inside = np.any(
        [(own >= left) & (own <= right) for left, right, what in body.unmeasured if what is kind],
        axis=0,
    )
    return float(pressure[inside].sum() / pressure.sum())


# In isolated contact the surface ends where the piece that joins it to the next period would
# begin. So the kind JOINED does not occur.
PAIRS = [
    (route, kind)
    for route in ROUTES
    for kind in Kind
    if kind is not Kind.JOINED or route not in ("isolated", "tilted")
]


QUICK = [(route, [*Kind][n % len(Kind)]) for n, route in enumerate(ROUTES)]


@pytest.mark.parametrize(("route", "kind"), quick(PAIRS, QUICK))
def test_the_reported_share_is_the_integral_of_the_pressure_on_every_route(
    route: str, kind: Kind, tmp_path: Path
) -> None:
    solution = contact.solve(ROUTES[route](with_crest_in(kind, tmp_path)), tol=1e-5)
    (borne,) = [borne for borne in shares(solution) if borne.kind is kind]
    assert borne.share > 0.02
    # The sum has errors at the ends of zones and where the border of an interval splits a zone.
    # With adhesion the pressure at the ends is infinite, so the tolerance is larger.
    assert borne.share == pytest.approx(
        integrated(solution, kind), abs=2e-2 if solution.scene.law.pulls else 5e-3
    )
    (told,) = [line for line in solution.warnings if kind.value[0] in line]
    assert (
        float(told.split(" %")[0]) == pytest.approx(100 * borne.share, abs=0.5) and "x = " in told
    )


@pytest.mark.parametrize("route", [name for name in ROUTES if name not in ("gaps", "full")])
def test_contact_on_measured_heights_only_causes_no_warning(route: str, tmp_path: Path) -> None:
    profile = trace(tmp_path, 0.5, taper=0.1, period=True)
    assert preparation_warnings(contact.solve(ROUTES[route](profile), tol=1e-5)) == ()


def test_given_points_have_no_unmeasured_interval_except_the_closing_one() -> None:
    assert contact.Sampled(X[:-1], surface(0.5)[:-1], period=LENGTH).unmeasured == ()
    assert contact.Sampled(X, surface(0.5)).unmeasured == ()
    (joined,) = contact.Sampled(X, surface(0.5), period=1.1 * LENGTH).unmeasured
    assert joined.kind is Kind.JOINED and joined[:2] == pytest.approx((LENGTH, 1.1 * LENGTH))


@pytest.mark.filterwarnings("always::contact.ModelWarning")
def test_the_warning_is_given_once_in_python_on_a_curve_in_json_and_by_the_command(
    tmp_path: Path,
) -> None:
    pytest.importorskip("click")
    from click.testing import CliRunner

    from contact.commands import cli

    given = scene(with_crest_in(Kind.TAPERED, tmp_path), load=200.0)
    with pytest.warns(contact.ModelWarning, match="tapered ends") as caught:
        solution = contact.solve(given, tol=1e-5)
    assert len(caught) == 1 and solution.warnings == [str(caught[0].message)]
    for curve in (contact.solve_many, contact.path):
        with pytest.warns(contact.ModelWarning, match="tapered ends") as caught:
            curve(given, [200.0, 300.0], tol=1e-5)
        assert len(caught) == 1
    tables = (
        '[profile]\nshape = "sampled"\nfile = "trace.csv"\ntaper = 0.2\nperiod = true\n[material]\nE_star = 1e11\n'
        '[interaction]\nmodel = "periodic"\n[control]\nload = 200.0\n'
    )
    (tmp_path / "scene.toml").write_text(tables)
    result = CliRunner().invoke(
        cli.main, ["solve", str(tmp_path / "scene.toml"), "--json", "--tol", "1e-5"]
    )
    assert result.exit_code == 0, result.stderr
    (said,) = json.loads(result.stdout)["warnings"]
    assert "tapered ends" in said and result.stderr == f"contact: warning: {said}\n"


def test_the_page_shows_the_warning(tmp_path: Path) -> None:
    from contact.explorer.session import Given, Session

    tab = Session(
        Given(scene(with_crest_in(Kind.TAPERED, tmp_path), load=200.0)), 1e-5, lambda: False
    )
    (said,) = tab.reply({"ask": "frame"})[0]["warnings"]
    assert "tapered ends" in said
