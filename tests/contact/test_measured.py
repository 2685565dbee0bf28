"""Reading measured traces: a stylus file as its instrument wrote it, other layouts, bad files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import contact
from contact import Sampled, SceneError
from contact.model.traces.dropouts import filled, in_order
from contact.model.traces.file import in_metres, read_table
from contact.model.traces.prepare import load_trace, subtract_trend, taper_ends, to_uniform

STYLUS = Path(__file__).parents[2] / "examples" / "data" / "stylus-profile.csv"


def read_columns(
    path: Path, columns: tuple[int | str, ...] = (), units: str | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(Positions [m], heights [m], line number of each point) from a text file."""
    table = read_table(path, columns)
    values, _ = in_metres(path, table, units)
    x, height, lines, _ = in_order(path, values[:, 0], values[:, 1], table.lines)
    filled(path, x, height, lines, None)
    return x, height, lines


def write(folder: Path, text: str | bytes, name: str = "trace.csv") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


ROWS = "0,1\n1,2\n2,0\n3,1\n4,5\n"


def test_the_stylus_file_is_read_as_it_came_from_the_instrument() -> None:
    x, h, lines = read_columns(STYLUS, units="um")
    assert x.size == 9600
    assert (x[0], x[-1]) == pytest.approx((0, 1499.8e-6), rel=1e-15)
    assert (h[0], h[-1]) == pytest.approx((-0.00933e-6, 16.58112e-6), rel=1e-15)
    assert lines[0] == 29


def test_the_stylus_profile_has_the_stated_roughness_and_spikes() -> None:
    trace = load_trace(STYLUS, units="um", detrend="quadratic", regrid=True)
    assert np.std(trace.height) == pytest.approx(0.038e-6, abs=0.001e-6)
    assert 0.13e-6 < np.max(trace.height) < 0.16e-6


def test_rounded_positions_are_recognised_and_the_pitch_behind_them_found() -> None:
    trace = load_trace(STYLUS, units="um", regrid=True)
    pitch = np.diff(trace.x)
    # The pitch is 1500 um / 9600. If n positions are rounded to a step q, a fitted line gives the
    # pitch with an error of about q/n^1.5.
    assert np.mean(pitch) == pytest.approx(1500e-6 / 9600, rel=1e-6)
    assert np.ptp(pitch) < 1e-12 * 1e-3
    assert any("rounding" in said for said in trace.history)


def test_taking_the_rounded_positions_as_they_stand_invents_slopes() -> None:
    rough = Sampled.from_file(STYLUS, units="um", detrend="quadratic")
    even = Sampled.from_file(STYLUS, units="um", detrend="quadratic", regrid=True)
    middle = np.linspace(1e-5, 1.49e-3, 20001)
    assert np.std(rough.slope(middle)) > 1.1 * np.std(even.slope(middle))


def test_the_stylus_file_becomes_one_period() -> None:
    s = Sampled.from_file(
        STYLUS, units=["um", "um"], detrend="quadratic", regrid=True, taper=0.05, period=True
    )
    assert s.period == pytest.approx(9599 * 1500e-6 / 9600, rel=1e-6)
    assert s.slope_conjugate([0.0]) is not None
    assert len(s.history) == 5


def test_a_scene_table_reads_a_file_next_to_it(tmp_path: Path) -> None:
    write(tmp_path, ROWS)
    made = Sampled.from_table({"file": "trace.csv", "units": "mm"}, tmp_path)
    assert made == Sampled(np.arange(5) * 1e-3, np.array([1, 2, 0, 1, 5]) * 1e-3)
    assert contact.profile("sampled", file=str(tmp_path / "trace.csv"), units="mm") == made
    with pytest.raises(SceneError, match="did you mean 'detrend'"):
        Sampled.from_table({"file": "trace.csv", "detrnd": "line"}, tmp_path)


@pytest.mark.parametrize(
    ("text", "columns"),
    [
        (ROWS, (0, 1)),
        (ROWS.replace(",", ";"), (0, 1)),
        (ROWS.replace(",", "\t"), (0, 1)),
        (ROWS.replace(",", "   "), (0, 1)),
        (ROWS.replace("\n", "\r\n"), (0, 1)),
        (ROWS.replace("\n", "\r\r\n"), (0, 1)),
        (ROWS.replace("\n", "\r"), (0, 1)),
        (ROWS.replace("\n", ",,\n"), (0, 1)),
        ("\ufeff" + ROWS, (0, 1)),
        ("# made by hand\n\n" + ROWS + "\n\n", (0, 1)),
        ("samples, 5\nwhat,ever\n" + ROWS, (0, 1)),
        ("5,2\nx,z\n" + ROWS, (0, 1)),
        ("x,z\n" + ROWS, ("x", "z")),
        ('"z" , "x"\n' + "\n".join(",".join(r.split(",")[::-1]) for r in ROWS.split()), ("x", "z")),
        ("i,x,z\n" + "\n".join(f"9,{r}" for r in ROWS.split()), (1, "z")),
    ],
)
def test_the_table_is_found_in_any_usual_layout(
    tmp_path: Path, text: str, columns: tuple[int | str, int | str]
) -> None:
    x, h, _ = read_columns(write(tmp_path, text), columns)
    assert x.tolist() == [0, 1, 2, 3, 4] and h.tolist() == [1, 2, 0, 1, 5]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("x,z\n0,1\n1,2\n2,abc\n3,1\n4,5\n", 4),
        ("0,1\n1,2\n2\n3,1\n4,5\n", 3),
        ("0,1\n1,2\n2,nan\n3,1\n4,5\n", 3),
        ("0,1\n1,2\n2,inf\n3,1\n4,5\n", 3),
        ("0,1\n\n1,2\n0.5,3\n3,1\n4,5\n", 4),
        ("0,1\n1,2\n1,3\n3,1\n4,5\n", 3),
        ("0,1\r\r\n1,2\r\r\n2,1_0\r\r\n3,1\r\r\n4,5\r\r\n", 3),
        ("0,1\n1,2\n2,3\n", 3),
    ],
)
def test_a_bad_row_is_named_by_file_and_line(tmp_path: Path, text: str, line: int) -> None:
    with pytest.raises(SceneError, match=rf"trace\.csv', line {line}:"):
        load_trace(write(tmp_path, text))


@pytest.mark.parametrize(
    "content", [b"", b"\n\n", b"only words\nand more\n", b"1,2\n", bytes(range(256))]
)
def test_a_file_without_a_table_is_refused_by_name(tmp_path: Path, content: bytes) -> None:
    with pytest.raises(SceneError, match=r"trace\.csv"):
        load_trace(write(tmp_path, content))


def test_a_missing_file_or_a_folder_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="nowhere"):
        Sampled.from_file(tmp_path / ("deep" * 30) / "nowhere.csv")
    with pytest.raises(SceneError, match="file"):
        Sampled.from_file(tmp_path)


@pytest.mark.parametrize(
    ("field", "bad"),
    [
        ("columns", [0]),
        ("columns", [0, 0]),
        ("columns", "xz"),
        ("columns", [0, -1]),
        ("columns", [0, 1.0]),
        ("columns", None),
        ("units", "furlong"),
        ("units", ["um"]),
        ("units", 3),
        ("units", ["um", None]),
        ("detrend", "cubic"),
        ("detrend", None),
        ("regrid", 3),
        ("regrid", 5.0),
        ("regrid", "yes"),
        ("taper", 0),
        ("taper", 0.6),
        ("taper", True),
        ("taper", np.nan),
        ("period", -1),
        ("period", "L"),
        ("period", 2.0),
        ("period", True),
    ],
)
def test_bad_arguments_are_refused_by_name(tmp_path: Path, field: str, bad: object) -> None:
    with pytest.raises(SceneError, match=field):
        Sampled.from_file(write(tmp_path, ROWS), **{field: bad})  # type: ignore[arg-type]


def test_unknown_column_names_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="header row"):
        read_columns(write(tmp_path, "x,z\n" + ROWS), ("x", "y"))


def test_detrend_removes_exactly_what_it_says() -> None:
    x = np.linspace(2.0, 3.0, 50)
    assert np.allclose(subtract_trend(x, 3 + 2 * x, "line"), 0, atol=1e-14)
    assert np.allclose(subtract_trend(x, 3 + 2 * x - 5 * x**2, "quadratic"), 0, atol=1e-13)
    assert np.max(np.abs(subtract_trend(x, x**2, "line"))) > 0.1


def test_a_taper_leaves_the_middle_alone_and_makes_the_ends_meet() -> None:
    x = np.linspace(0, 1, 2001)
    h = np.sin(9 * x) + x
    t = taper_ends(x, h, 0.1)
    inside = (x > 0.1) & (x < 0.9)
    assert np.allclose(t[inside], h[inside], rtol=0, atol=1e-15)
    assert t[0] == t[-1]
    # The blend begins as (pi s)^2/4, where s is the distance from the end divided by a tenth of the
    # length. One point from the end, the blend is 6e-5 of the offset.
    assert abs(t[1] - t[0]) == pytest.approx((np.pi * 0.005) ** 2 / 4 * abs(h[1] - t[0]), rel=1e-4)


def test_regrid_keeps_even_points_and_interpolates_uneven_ones() -> None:
    even = np.linspace(0, 1, 40)
    x, h, _ = to_uniform(even, np.cos(even), 40)
    assert np.allclose(x, even, rtol=0, atol=1e-15) and np.array_equal(h, np.cos(even))
    uneven = np.sort(np.random.default_rng(0).uniform(0, 1, 40))
    x, h, said = to_uniform(uneven, 2 * uneven, 25)
    assert x.size == 25 and np.allclose(h, 2 * x, rtol=1e-13) and "linearly" in said


def test_rounding_that_repeats_positions_is_mended_and_other_repeats_are_not(
    tmp_path: Path,
) -> None:
    x = np.round(0.04 * np.arange(100), 1)
    even, h, said = to_uniform(x, np.arange(100.0), 100)
    assert (
        "rounding" in said and np.ptp(np.diff(even)) < 1e-12 and np.array_equal(h, np.arange(100.0))
    )
    assert np.mean(np.diff(even)) == pytest.approx(0.04, rel=1e-3)
    x = np.linspace(0, 1, 100)
    x[50] = x[49]
    with pytest.raises(SceneError, match="is repeated, and rounding does not explain it"):
        load_trace(
            write(tmp_path, "\n".join(f"{place:.17g},{place:.17g}" for place in x)),
            units="mm",
            regrid=True,
        )
