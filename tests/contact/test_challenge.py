"""The contact challenge: its files are what is solved now, and its judge tells right from wrong."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import contact
from contact.studies import challenge
from tests.tiers import quick

NAMES = [problem.name for problem in challenge.PROBLEMS]


@pytest.mark.parametrize("name", quick(NAMES, ["few"]))
def test_a_file_is_what_its_seed_makes_and_what_is_solved_now(name: str) -> None:
    (problem,) = (one for one in challenge.PROBLEMS if one.name == name)
    truth = challenge.read(name)
    profile = contact.Fourier(1.0, truth["cosine"], truth["sine"])
    assert np.asarray(profile.cosine) == pytest.approx(
        np.asarray(problem.profile.cosine), rel=1e-12, abs=1e-18
    )
    detail = truth["detail"]
    solution = contact.solve(
        contact.Scene(profile, 1.0, contact.Periodic(), mean_pressure=detail["mean_pressure"])
    )
    zones = np.array(detail["zones"])
    allowed = detail["error"] + solution.error
    assert np.abs(solution.zones - zones).max(axis=1) == pytest.approx(
        0.0, abs=2 * allowed * np.ptp(zones, axis=1).max()
    )
    off = challenge.judged(
        {"problem": name, **challenge._numbers(solution), **challenge._pressures(solution)}
    )
    assert (
        off["pressure, largest"]
        <= (detail["pressure_error"] + 1e2 * allowed * detail["max_pressure"])
        / detail["max_pressure"]
    )
    assert max(off[what] for what in ("contact_fraction", "mean_gap", "max_pressure")) <= 1e-7
    assert all(row["error"] <= challenge.TOL for row in truth["curve"])


def test_areas_grow_and_gaps_shrink_with_the_load() -> None:
    for name in NAMES:
        curve = challenge.read(name)["curve"]
        areas, gaps = ([row[what] for row in curve] for what in ("contact_fraction", "mean_gap"))
        assert np.all(np.diff(areas) > 0) and np.all(np.diff(gaps) < 0)


def test_a_wrong_answer_is_as_far_off_as_it_is() -> None:
    truth = challenge.read("few")["detail"]
    right = {
        "problem": "few",
        **{
            key: truth[key]
            for key in ("mean_pressure", "contact_fraction", "mean_gap", "x", "pressure")
        },
    }
    assert max(challenge.judged(right).values()) < 1e-12
    wrong = right | {
        "contact_fraction": 1.01 * truth["contact_fraction"],
        "pressure": (1.02 * np.array(truth["pressure"])).tolist(),
    }
    off = challenge.judged(wrong)
    assert (
        off["contact_fraction"] == pytest.approx(0.01)
        and 0.01 < off["pressure, largest"] <= 0.02 + 1e-12
    )
    with pytest.raises(contact.SceneError, match="did you mean 'few'"):
        challenge.judged(right | {"problem": "fewer"})
    with pytest.raises(contact.SceneError, match="mean_pressure"):
        challenge.judged(right | {"mean_pressure": 1.0})


def test_a_grid_comes_closer_with_its_steps(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A code of even pressures, here the true ones: what a grid cannot see is what it is off by."""
    truth = challenge.read("few")
    profile = contact.Fourier(1.0, truth["cosine"], truth["sine"])
    solution = contact.solve(contact.Scene(profile, 1.0, contact.Periodic(), mean_pressure=5e-4))
    far = []
    for grid in (512, 8192):
        x = profile.x0 + np.arange(grid) / grid
        answer = challenge.answered("few", 5e-4, lambda heights, x=x: solution.pressure(x), grid)
        assert answer is not None
        far.append(challenge.judged(answer))
    assert (
        far[1]["mean_gap"] < 0.1 * far[0]["mean_gap"]
        and far[1]["pressure, mean"] < 0.1 * far[0]["pressure, mean"]
    )
    file = tmp_path / "answer.json"
    file.write_text(
        json.dumps({key: np.asarray(value).tolist() for key, value in answer.items()}),
        encoding="utf-8",
    )
    challenge.main(["judge", str(file)])
    assert "mean_gap" in capsys.readouterr().out
