"""Trace files as instruments and spreadsheets write them: read right, or refused with a reason."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

import contact
from contact import Sampled, SceneError

X = 0.5 * np.arange(12)
Z = np.round(np.random.default_rng(3).uniform(-2, 2, 12), 3)
Z[1:3] = 0.25, -0.5


def table(delimiter: str, decimal: str = ".", index: bool = False, form: str = "{:.3f}") -> str:
    rows = (
        [f"{i}"] * index + [form.format(x), form.format(z)]
        for i, (x, z) in enumerate(zip(X, Z, strict=True))
    )
    return "".join(
        delimiter.join(cell.replace(".", decimal) for cell in row) + "\n" for row in rows
    )


def write(folder: Path, content: str | bytes) -> Path:
    path = folder / "trace.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def refused(folder: Path, content: str | bytes, *words: str, **options: object) -> str:
    with pytest.raises(SceneError) as caught:
        Sampled.from_file(write(folder, content), **options)  # type: ignore[arg-type]
    message = str(caught.value)
    assert all(word in message for word in words), message
    return message


UM, BOTH = {"units": "um"}, {"units": ["um", "nm"]}


@pytest.mark.parametrize(
    ("content", "options", "height"),
    [
        (table(",", ","), {"decimal": ",", **UM}, 1e-6),
        ("Weg [mm],Höhe [µm]\n" + table(",", ","), {"decimal": ","}, 1e-6),
        (table(",", ",", form='"{:.3f}"'), UM, 1e-6),
        (table(";", ","), UM, 1e-6),
        (table(";", ",", form="{:g}"), UM, 1e-6),
        (table(";", ",", form="{:.3E}"), UM, 1e-6),
        (table("\t", ","), UM, 1e-6),
        (table("  ", ","), UM, 1e-6),
        (table(";", ",").replace("\n", ";\r\n"), UM, 1e-6),
        ("\ufeffx [um]; z [nm]\r\n" + table(";", ",").replace("\n", "\r\n"), {}, 1e-9),
        (("x [um]\tz [nm]\r\n" + table("\t", ",")).encode("utf-16"), {}, 1e-9),
        (gzip.compress(table(",").encode()), UM, 1e-6),
        ("# x [um]   z [nm]\n" + table("   "), {}, 1e-9),
        ("Lateral um,Raw nm,\n" + table(",").replace("\n", ",\n"), {}, 1e-9),
        ("x,z\num,nm\n" + table(","), {}, 1e-9),
        ("     Profile 1     \n    x     y   \n  [um]   [nm]\n" + table("  "), {}, 1e-9),
        ("Tip radius, 2 mm\nx_um,z_nm\n" + table(","), {}, 1e-9),
        ("Tip radius, 2 mm\nx,z\n" + table(","), UM, 1e-6),
        ("x [um],z [nm]\n" + table(","), BOTH, 1e-9),
        ("i,x [um],z [nm]\n" + table(",", index=True), {"columns": ["x", "z"]}, 1e-9),
        (table(",", index=True), {"columns": [1, 2], **UM}, 1e-6),
        (table(", ", index=True), {"columns": [1, 2], **UM}, 1e-6),
        (table(",").replace("\n", ",ok\n"), UM, 1e-6),
        (table(";").replace("-", "\u2212"), UM, 1e-6),
        ("".join(f"{z:.3f}\n" for z in Z), {"pitch": 5e-7, **UM}, 1e-6),
        (
            "".join(f"{z:.3f}\n" for z in Z).replace(".", ","),
            {"pitch": 5e-7, "decimal": ",", **UM},
            1e-6,
        ),
    ],
)
def test_a_file_with_one_possible_reading_is_read(
    tmp_path: Path, content: str | bytes, options: dict, height: float
) -> None:
    read = Sampled.from_file(write(tmp_path, content), **options)
    assert np.allclose(read.x / read.x[1], X / X[1], rtol=1e-12)
    assert np.allclose(read.heights, height * Z, rtol=1e-12)


@pytest.mark.parametrize(
    "options", [{}, UM, {"columns": [0, 1]}, {"delimiter": ","}, {"columns": ["x", "z"]}], ids=str
)
def test_commas_between_columns_and_in_numbers_are_refused_with_both_readings(
    tmp_path: Path, options: dict
) -> None:
    """If the rows were read as four columns, the heights would be the decimals of the positions."""
    readings = (
        "'0,500,0,250'",
        "0 | 500 | 0 | 250",
        "0,500 | 0,250",
        'decimal = "."',
        'decimal = ","',
    )
    content = table(",", ",").split("\n", 1)[1]
    refused(tmp_path, "x,z\n" + content, *readings, **options)


def test_whole_numbers_in_three_columns_are_refused_if_a_comma_may_be_a_decimal_mark(
    tmp_path: Path,
) -> None:
    rows = "".join(f"{i},{10 * i},{i * i % 7}\n" for i in range(8))
    refused(tmp_path, rows, "0 | 0 | 0", 'decimal = "."', columns=[1, 2])
    with pytest.warns(contact.ModelWarning):
        assert Sampled.from_file(write(tmp_path, rows), columns=[1, 2], decimal=".").x[1] == 10.0
    assert Sampled.from_file(write(tmp_path, "i,x,z\n" + rows), columns=[1, 2], units="um").x[
        1
    ] == pytest.approx(1e-5)
    refused(tmp_path, rows, "every number must have decimals", decimal=",")


def test_a_comma_that_may_mark_thousands_or_decimals_is_refused(tmp_path: Path) -> None:
    rows = "".join(f"1,{100 + i};{i % 3}\n" for i in range(8))
    refused(tmp_path, rows, "'1,100' can be read as 1.100 or as 1100", 'decimal = ","')
    assert Sampled.from_file(write(tmp_path, rows), units="um", decimal=",").x[0] == pytest.approx(
        1.1e-6
    )


@pytest.mark.parametrize(("form", "decimal"), [("{:,.2f};{:.2f}", "."), ("{:,.2f}\t{:.2f}", ",")])
def test_separated_thousands_are_refused(tmp_path: Path, form: str, decimal: str) -> None:
    swap = str.maketrans(",.", ".,") if decimal == "," else {}
    rows = "".join(
        form.format(1000 * x, z).translate(swap) + "\n" for x, z in zip(X, Z, strict=True)
    )
    refused(tmp_path, rows, "thousands")


@pytest.mark.parametrize("regrid", [None, True])
def test_the_same_comma_between_thousands_and_between_columns_is_refused(
    tmp_path: Path, regrid: bool | None
) -> None:
    """If the commas separated columns, the positions would be 1, 1, 1, ... 2, 2.

    Such positions might be taken for rounded ones.
    """
    rows = "".join(f"{1000 + 20.5 * i:,.1f},{i % 7}\n" for i in range(80))
    refused(tmp_path, rows, "'000.0' in '1,000.0,0'", units="um", columns=[0, 1], regrid=regrid)
    refused(tmp_path, "".join(f"{i},{i % 7:02}\n" for i in range(8)), "'00' in '0,00'", units="um")
    padded = "".join(f"{i / 2:07.2f},{i % 7:07.2f}\n" for i in range(8))
    assert Sampled.from_file(write(tmp_path, padded), units="um").x[1] == pytest.approx(0.5e-6)


def test_more_columns_than_two_are_refused_with_the_readings_unless_chosen(tmp_path: Path) -> None:
    message = refused(
        tmp_path,
        table(",", index=True),
        "3 columns of numbers",
        "0 | 0.000",
        "columns = [0, 1]",
        "columns = [1, 2]",
    )
    assert "line 1" in message
    refused(tmp_path, "i;x;z\n" + table(";", index=True), "columns = [1, 2] for 'x' and 'z'", **UM)
    refused(tmp_path, table(","), "2 columns of numbers", "columns = [1]", pitch=1e-6)


@pytest.mark.parametrize("name", ["index", "No.", "#", "", "Point"])
def test_a_column_that_counts_the_points_holds_no_positions(tmp_path: Path, name: str) -> None:
    rows = f"{name},height [um]\n" + "".join(f"{i},{z}\n" for i, z in enumerate(Z))
    refused(
        tmp_path,
        rows,
        "count the points",
        "columns = [1] and pitch",
        "columns = [0, 1]",
        units="um",
    )
    assert Sampled.from_file(write(tmp_path, rows), columns=[1], pitch=5e-7).x[1] == pytest.approx(
        5e-7
    )
    assert Sampled.from_file(write(tmp_path, rows), columns=[0, 1], units="um").x[
        1
    ] == pytest.approx(1e-6)


def test_one_column_needs_a_pitch(tmp_path: Path) -> None:
    heights = "".join(f"{abs(z)}\n" for z in Z)
    refused(tmp_path, heights, "pitch")
    refused(tmp_path, heights, "pitch", pitch=-1.0)
    refused(
        tmp_path,
        heights.replace(".", ","),
        "can be read as 2 columns",
        'decimal = ","',
        pitch=1e-6,
        units="um",
    )
    refused(tmp_path, table(","), "columns", pitch=1e-6, columns=[0, 1])


@pytest.mark.parametrize(
    ("header", "units", "said"),
    [
        ("x [um], z [nm]", "m", '["um", "nm"]'),
        ("# x [um], z [nm]", "um", '["um", "nm"]'),
        ("x (mm),z (mm)", "um", '"mm"'),
        ("Weg/µm,Höhe/µm", "nm", '"µm"'),
        ("x,z [nm]", "um", '"nm"'),
        ("x [um],z", None, "no unit for some columns"),
    ],
)
def test_units_that_contradict_the_header_are_refused(
    tmp_path: Path, header: str, units: str | None, said: str
) -> None:
    refused(tmp_path, f"{header}\n{table(',')}", "units", "line 1", said, units=units)


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (table(",").replace("-0.500", "nan"), "line 3"),
        (table(",").replace("-0.500", "***"), "line 3"),
        (table(",").replace("-0.500", "0.5 ?"), "no two numbers"),
        (table(",").replace("-0.500", ""), "line 3"),
        (
            "\n".join(table(",").split()[5:] + table(",").split()[:5]),
            "positions must increase or decrease throughout",
        ),
        ("".join(f"{z},{x}\n" for x, z in zip(X, Z, strict=True)), "columns = [1, 0]"),
        ("".join(f"3.0,{z}\n" for z in Z), "all positions are"),
        (b"PK\x03\x04" + bytes(100), "spreadsheet"),
        (b"\x89HDF" + bytes(100), "binary"),
        (table(",").encode("utf-16-le"), "binary"),
        (gzip.compress(table(",").encode())[:40], "can be read"),
        ("", "no two successive rows have numbers"),
        ("0.5,1.2\n", "no two successive rows have numbers"),
    ],
)
def test_a_file_that_is_no_table_of_a_trace_is_refused_with_the_reason(
    tmp_path: Path, content: str | bytes, word: str
) -> None:
    refused(tmp_path, content, word, units="um")


@pytest.mark.parametrize("field", ["decimal", "delimiter", "pitch"])
@pytest.mark.parametrize("bad", ["x", 3.5j, [","], True, float("nan"), ""], ids=repr)
def test_bad_options_of_the_layout_are_refused_by_name(
    tmp_path: Path, field: str, bad: object
) -> None:
    refused(tmp_path, table(","), f"{field} = ", **{field: bad})


@pytest.mark.parametrize(
    "heights",
    [lambda x: 3.1 + 0 * x, lambda x: 0.1 + 0.3 * x, lambda x: 1e3 - 0.7 * x],
    ids="constant line slope".split(),
)
@pytest.mark.parametrize("detrend", ["none", "line", "quadratic"])
@pytest.mark.parametrize("taper", [None, 0.1])
def test_heights_constant_to_rounding_are_refused(
    tmp_path: Path, heights, detrend: str, taper: float | None
) -> None:
    """After the trend of a line is subtracted, only round-off is left.

    It has about as many peaks as there are points.
    """
    if detrend == "none" and heights(X)[0] != heights(X)[1]:
        return
    rows = "".join(
        f"{1000 + x!r},{z!r}\n" for x, z in zip(X.tolist(), heights(X).tolist(), strict=True)
    )
    refused(tmp_path, rows, "the same everywhere", units="um", detrend=detrend, taper=taper)
    with pytest.raises(SceneError, match="not all equal"):
        contact.Sampled(X, np.where(X > 2, 0.3, 0.1 + 0.2))


def test_regrid_makes_no_millions_of_points(tmp_path: Path) -> None:
    refused(tmp_path, table(","), "regrid = 2000000", "at most 20000", regrid=2_000_000, units="um")
    assert Sampled.from_file(write(tmp_path, table(",")), units="um", regrid=2000).x.size == 2000


def test_the_history_says_in_which_units_a_file_was_read(tmp_path: Path) -> None:
    assert (
        "the header's"
        in Sampled.from_file(write(tmp_path, "x [um],z [nm]\n" + table(","))).history[0]
    )
    assert '"um"' in Sampled.from_file(write(tmp_path, table(",")), units="um").history[0]
