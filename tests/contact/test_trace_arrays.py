"""Traces given as arrays, quantities, file objects and line scans. Each gives the same profile as
a file of the same numbers.
"""

from __future__ import annotations

import gzip
import io
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import contact
from contact import Sampled, SceneError, read_trace

X = 5.0 * np.arange(101)  # [um]
Z = np.round(40 * np.cos(X / 30) + 0.1 * X, 3)  # [nm]
HOLED = np.where(np.arange(X.size) == 7, np.nan, Z)
TEXT = "x [um];z [nm]\n" + "\n".join(
    f"{x!r};{z!r}" for x, z in zip(X.tolist(), HOLED.tolist(), strict=True)
)
# No point lies at the end of the taper. There, round-off would decide whether the point is
# tapered.
STEPS: dict[str, Any] = {"fill": "linear", "detrend": "line", "taper": 0.093, "period": True}


class Quantity:
    """A stand-in for a quantity of pint. `metre` is the unit in metres, or None if the unit is no
    length.
    """

    def __init__(self, magnitude: Any, metre: float | None) -> None:
        self.magnitude, self.metre = magnitude, metre

    def to(self, unit: str) -> Quantity:
        if unit != "m" or self.metre is None:
            raise ValueError(f"cannot convert to {unit}")
        return Quantity(self.magnitude * self.metre, 1.0)


class Scan:
    """A stand-in for a line scan of SurfaceTopography, with the methods that are used. Its
    lengths are in nm.
    """

    def __init__(self, scale: float = 1.0, unit: str | None = "nm") -> None:
        self.scale, self.unit, self.dim = scale, unit, 1

    def to_unit(self, unit: str) -> Scan:
        assert unit == "m"
        return Scan(1e-9, "m")

    def positions(self) -> np.ndarray:
        return 1e3 * X * self.scale

    def heights(self) -> np.ma.MaskedArray:
        return np.ma.masked_invalid(HOLED * self.scale)


@pytest.fixture(scope="module")
def from_file(tmp_path_factory: pytest.TempPathFactory) -> Sampled:
    path = tmp_path_factory.mktemp("traces") / "trace.csv"
    path.write_text(TEXT)
    return read_trace(path, **STEPS)


@pytest.mark.parametrize(
    "read",
    [
        lambda: read_trace((X * 1e-6, HOLED * 1e-9), **STEPS),
        lambda: read_trace([list(X), list(HOLED)], units=("um", "nm"), **STEPS),
        lambda: read_trace(np.ma.masked_invalid(HOLED) * 1e-9, pitch=5e-6, **STEPS),
        lambda: read_trace((Quantity(X, 1e-6), Quantity(HOLED, 1e-9)), **STEPS),
        lambda: read_trace(Quantity(HOLED, 1e-9), pitch=Quantity(5.0, 1e-6), **STEPS),
        lambda: Sampled.prepared(X[::-1] * 1e-6, HOLED[::-1] * 1e-9, **STEPS),
        lambda: Sampled.prepared(X, -HOLED * 1e-3, units="um", invert=True, **STEPS),
        lambda: read_trace(Scan(), **STEPS),
        lambda: read_trace(io.StringIO(TEXT), **STEPS),
        lambda: read_trace(io.BytesIO(TEXT.encode("utf-16")), **STEPS),
        lambda: read_trace(io.BytesIO(gzip.compress(TEXT.encode())), **STEPS),
    ],
)
def test_arrays_and_streams_give_the_profile_of_the_file_with_the_same_numbers(
    from_file: Sampled, read: Callable[[], Sampled]
) -> None:
    trace = read()
    assert trace.x == pytest.approx(from_file.x, rel=1e-12, abs=1e-18)
    assert trace.heights == pytest.approx(from_file.heights, rel=1e-11, abs=1e-20)
    assert trace.period == pytest.approx(from_file.period, rel=1e-12)
    assert trace.history[-3:] == from_file.history[-3:]
    assert len(trace.unmeasured) == len(from_file.unmeasured) == 3


def test_an_open_file_is_read_in_text_and_in_binary_mode(
    from_file: Sampled, tmp_path: Path
) -> None:
    path = tmp_path / "trace.csv"
    path.write_text(TEXT)
    for mode in ("r", "rb"):
        with path.open(mode) as stream:
            trace = read_trace(stream, **STEPS)
        assert np.array_equal(trace.heights, from_file.heights)
        assert trace.history[0] == from_file.history[0]


def test_points_with_units_of_their_own_are_metres_in_a_sampled_profile() -> None:
    trace = Sampled(Quantity(X, 1e-6), Quantity(Z, 1e-9))  # type: ignore[arg-type]
    assert trace.x == pytest.approx(X * 1e-6) and trace.heights == pytest.approx(Z * 1e-9)


def test_a_prepared_array_is_prepared_again_in_another_way() -> None:
    trace = Sampled.prepared(X * 1e-6, Z * 1e-9, detrend="line")
    again = trace.varied({"profile": {"detrend": "quadratic"}})
    other = Sampled.prepared(X * 1e-6, Z * 1e-9, detrend="quadratic")
    assert np.array_equal(again.heights, other.heights)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("read", "message"),
    [
        (lambda: read_trace((X, Z[1:])), r"z = .* as many heights as positions x \(101, not 100\)"),
        (lambda: read_trace((X * 1e-6, HOLED)), r"\(x, z\), element 7: no finite height"),
        (lambda: read_trace((HOLED, Z)), r"\(x, z\), element 7: the position is not finite"),
        (lambda: read_trace((X, Z), units="furlong"), "units = 'furlong' is not known"),
        (lambda: read_trace((np.r_[X[1:], X[0]], Z)), r"element 100: positions must increase"),
        (lambda: read_trace((X, Z.reshape(1, -1))), r"z = .* one-dimensional .*shape \(1, 101\)"),
        (lambda: read_trace(np.column_stack((X, Z))), r"table\[:, 0\]"),
        (lambda: read_trace(([], [])), r"z = \[\] is refused"),
        (lambda: read_trace([]), "a pair"),
        (lambda: read_trace(Z), "heights with pitch"),
        (lambda: read_trace((X, Z), pitch=1.0), "pitch = 1.0 is refused: it must be left out"),
        (lambda: read_trace((X, Z, Z)), "a pair"),
        (lambda: read_trace((X, Z), columns=(0, 1)), "columns = .* left out"),
        (lambda: read_trace(Scan(), line=2), r"line = 2 is refused.*one line scan"),
        (lambda: read_trace(Scan(), along="x"), r"along = 'x' is refused.*one line scan"),
        (lambda: read_trace(None), "path_or_arrays = None is refused"),
        (lambda: read_trace((X, Z + 0j)), "z = .* real numbers"),
        (lambda: read_trace((Quantity(X, None), Quantity(Z, 1.0))), "x = .* a length"),
        (lambda: read_trace((Quantity(X, 1.0), Z)), "with a unit if x has a unit"),
        (
            lambda: read_trace((Quantity(X, 1.0),) * 2, units="um"),
            "units = 'um' .* their own units",
        ),
        (lambda: read_trace(Scan(unit=None)), "it has no unit"),
        (lambda: read_trace(Scan(), line=1), "line = 1 is refused"),
        (lambda: read_trace(io.StringIO("")), "rows left to read"),
        (lambda: read_trace(SimpleNamespace(read=lambda: 1)), "text or bytes"),
        (lambda: Sampled.prepared(X, Z, detrand=1), "did you mean 'detrend'"),
        (lambda: contact.Fourier(1.0, Quantity([1.0], 1.0), [0.0]), "cosine = .*without a unit"),  # type: ignore[arg-type]
        (lambda: contact.Sinusoid(Quantity(1.0, 1.0), 1.0), "amplitude = .*without a unit"),  # type: ignore[arg-type]
    ],
)
def test_wrong_arrays_are_refused_by_name(read: Callable[[], Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        read()
