"""Text files that are easily misread: each is read right, refused by name, or warned about."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import contact
from contact.commands import cli

N = 40
X = 0.25 * np.arange(N)
Z = np.round(0.3 * np.cumsum(np.random.default_rng(1).normal(size=N)), 3)
UM = "x [um];z [um]\n"
HOLES = (5, 6, 20)


def table(x=X, z=Z, between: str = ";", mark: str = ".") -> str:
    """Rows of positions and heights; heights that are strings are written unchanged."""
    cells = ((f"{a:g}", b if isinstance(b, str) else f"{b:.6g}") for a, b in zip(x, z, strict=True))
    return "".join(f"{a.replace('.', mark)}{between}{b.replace('.', mark)}\n" for a, b in cells)


def holed(word: str) -> list[float | str]:
    return [word if i in HOLES else z for i, z in enumerate(Z.tolist())]


def column(heights=Z) -> str:
    return "".join(f"{z}\n" for z in heights)


def read(folder: Path, content: str | bytes, **keys: object) -> contact.Sampled:
    path = folder / "trace.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with warnings.catch_warnings():
        warnings.simplefilter("error", contact.ModelWarning)
        return contact.read_trace(path, **keys)  # type: ignore[arg-type]


def refused(folder: Path, content: str | bytes, *words: str, **keys: object) -> None:
    with pytest.raises(contact.SceneError) as caught:
        read(folder, content, **keys)
    message = str(caught.value)
    assert len(message) < 400 and all(word in message for word in words), message


def warned(folder: Path, content: str, *words: str, **keys: object) -> None:
    with pytest.raises(contact.ModelWarning) as caught:
        read(folder, content, **keys)
    message = str(caught.value)
    assert len(message) < 400 and all(word in message for word in words), message


def same(found: contact.Sampled, scales: tuple[float, float], z=Z) -> None:
    assert found.x == pytest.approx(scales[0] * X, rel=1e-12)
    assert found.heights == pytest.approx(scales[1] * np.asarray(z), rel=1e-12)


# Units ------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("word", "scale"),
    [
        ("mm.", 1e-3), ("мм", 1e-3), ("毫米", 1e-3), ("㎜", 1e-3), ("MM", 1e-3),
        ("Millimètres", 1e-3), ("мкм", 1e-6), ("微米", 1e-6), ("㎛", 1e-6), ("\u00b5m", 1e-6),
        ("\u03bcm", 1e-6), ("Âµm", 1e-6), ("Mikrometer", 1e-6), ("ミクロン", 1e-6), ("нм", 1e-9),
        ("纳米", 1e-9), ("nanometres", 1e-9), ("in.", 0.0254), ("inch", 0.0254), ("Zoll", 0.0254),
        ("″", 0.0254), ("дюйм", 0.0254), ("mil", 2.54e-5), ("thou", 2.54e-5),
        ("\u00b5in", 2.54e-8), ("Ångström", 1e-10), ("\u212b", 1e-10), ("A", 1e-10),
        ("km", 1e3), ("dm", 0.1), ("ft", 0.3048), ("m", 1.0),
    ],
)  # fmt: skip
@pytest.mark.parametrize(
    "header", ["X ({0});Z [{0}]", "X/{0};Z/{0}", "x;z\n{0};{0}", "X, {0};Z, {0}"]
)
def test_the_usual_names_of_units_are_known(
    tmp_path: Path, word: str, scale: float, header: str
) -> None:
    # In the given unit, the numbers are a plausible trace.
    x, z = X * 1e-6 / scale, Z * 1e-7 / scale
    rows = "".join(f"{a!r};{b!r}\n" for a, b in zip(x.tolist(), z.tolist(), strict=True))
    same(read(tmp_path, f"{header.format(word)}\n{rows}"), (1e-6, 1e-7))
    assert read(tmp_path, rows, units=word).x == pytest.approx(1e-6 * X)


@pytest.mark.parametrize(
    "word",
    [
        "px", "V", "mV", "rad", "degrees", "°", "s", "counts", "%", "a.u.", "furlong", "mm/s",
        "mm²", "1e-6 m", "M", "-", "\ufffdm",
    ],
)  # fmt: skip
@pytest.mark.parametrize("first", ["{}", "um"])
def test_a_word_that_is_no_unit_of_lengths_is_refused(
    tmp_path: Path, word: str, first: str
) -> None:
    content = f"X ({first.format(word)});Z [{word}]\n{table()}"
    refused(tmp_path, content, "units", "line 1", repr(word))


@pytest.mark.parametrize(
    ("header", "scales"),
    [
        ("x;z\num;nm\n# by hand\n", (1e-6, 1e-9)),
        ("x;z\n[мкм];(нм)\nremark\n-----\n[Data]\n", (1e-6, 1e-9)),
        ("x;z\num;nm\n40\n", (1e-6, 1e-9)),
        ("x_mm;z_um\n", (1e-3, 1e-6)), ("Xmm;Zum\n", (1e-3, 1e-6)), ("x-mm;z.um\n", (1e-3, 1e-6)),
        ("X, мм;Z, мкм\n", (1e-3, 1e-6)), ("Weg in mm;Höhe in µm\n", (1e-3, 1e-6)),
        ("x;z\num;nm\n", (1e-6, 1e-9)), ("Position um,Profile 1 nm\n", (1e-6, 1e-9)),
        ("x: mm;z: um\n", (1e-3, 1e-6)), ("[um] x;[nm] z\n", (1e-6, 1e-9)),
        ("x [um] raw;z [nm] raw\n", (1e-6, 1e-9)), ("x / mm;z / um\n", (1e-3, 1e-6)),
        ("位置（ｍｍ）;高さ（μｍ）\n", (1e-3, 1e-6)),
        ("Profile 1 (raw);Profile 1 (raw)\nx [um];z [um]\n", (1e-6, 1e-6)),
        ("Model: Talysurf 50;Serial 12\n3:45 PM;2024\nFilter;8 mm\nx [mm];z [um]\n", (1e-3, 1e-6)),
    ],
)  # fmt: skip
def test_units_are_found_wherever_headers_have_them(
    tmp_path: Path, header: str, scales: tuple[float, float]
) -> None:
    same(read(tmp_path, header + table()), scales)


@pytest.mark.parametrize(
    ("content", "word"),
    [
        ("x;z\nfurlong;smoot\n" + table(), "furlong"),
        ("X_furlongs;Height_smoot\n" + table(), "furlongs"),
        ("X furlongs;Height smoot\n" + table(), "furlongs"),
        ("x;z\n[mm];[smoot]\n" + table(), "smoot"),
        ("a;b\nsmoot;smoot\n" + table(), "smoot"),
        ("X/smoot;Z/µm\n" + table(), "smoot"),
        ("Weg in Ellen;Höhe in Ellen\n" + table(), "Ellen"),
        ("t s;z V\n" + table(), "'s'"),
        ("Weg;Höhe V\n" + table(), "'V'"),
        ("X (мм);Z (мм)\n".encode("cp1251") + table().encode(), "ìì"),
        ("# Units: mm\nx;z\n" + table(), "'mm'"),
        ("# Position um Profile 1 nm\n" + table(between=" "), "'um'"),
        ("Position/smoot Profile 1/smoot\n" + table(between=" "), "smoot"),
        ("x;z\nsmoot;\n" + table(), "smoot"),
        ("x_smoot;z_smoot\n" + table(), "smoot"),
        ("Speed;0.5 mm/s\nx;z\n" + table(), "'mm'"),
        ("Ra [um];Rz [um]\n0.3;2.1\nx;z\n" + table(), "'um'"),
        ("x;z\n;um\n" + table(), '["?", "um"]'),
        ("All lengths in 微米\n" + table(), "微米"),
    ],
)
def test_unknown_or_misplaced_units_are_not_ignored(
    tmp_path: Path, content: str | bytes, word: str
) -> None:
    """If the unit were ignored, the numbers would be taken for metres."""
    refused(tmp_path, content, "units must be given", word)


@pytest.mark.parametrize(
    "header",
    [
        "Position um Height nm", "Position / um   Height / nm", "Position, um  Height, nm",
        "[um] Position  [nm] Height", "Position in um Height in nm", "x_um z_nm", "um nm",
        "Position [um] Height [nm]", "Position 1[um] Height 2[nm]", "Position: um Height: nm",
    ],
)  # fmt: skip
@pytest.mark.parametrize("between", [" ", "   "])
@pytest.mark.parametrize("start", ["", "# ", "Begin of scan\n", "Date: 3/4/2024\n"])
def test_units_between_blanks_belong_to_the_names_next_to_them(
    tmp_path: Path, header: str, between: str, start: str
) -> None:
    same(read(tmp_path, f"{start}{header}\n{table(between=between)}"), (1e-6, 1e-9))


def test_units_between_the_numbers_are_not_ignored(tmp_path: Path) -> None:
    rows = "".join(f"{x:g} um  {z:g} um\n" for x, z in zip(X, Z, strict=True))
    refused(tmp_path, rows, "units must be given", "'um'", columns=[0, 2])


def test_given_units_replace_unknown_words_but_not_volts(tmp_path: Path) -> None:
    same(read(tmp_path, "X (smoot);Z (smoot)\n" + table(), units="mm"), (1e-3, 1e-3))
    refused(tmp_path, "X (um);Z (V)\n" + table(), "'V'", "convert", units="um")
    refused(tmp_path, table(), "units = 'V'", units="V")


def test_a_remark_does_not_give_the_unit_of_a_column_of_heights(tmp_path: Path) -> None:
    for remark in ("# pitch 0.5 um", "# dx = 0.5 um", "z\nCutoff [mm] 0.8"):
        refused(tmp_path, f"{remark}\n{column()}", "units must be given", pitch=1e-6)
    assert read(tmp_path, "z\nnm\n" + column(), pitch=1e-6).heights == pytest.approx(1e-9 * Z)


@pytest.mark.parametrize("scale", [1.0, 0.05])
def test_without_units_metres_are_assumed_with_a_warning_if_they_are_implausible(
    tmp_path: Path, scale: float
) -> None:
    warned(tmp_path, table(scale * X, 1e-3 * Z), "(no units given)", "set units")
    half = 1e-3 * np.arange(501)
    warned(tmp_path, table(half, 1e-4 * np.sin(300 * half)), "500 mm long", "pitch of 1 mm")


# Rows without a point, and numbers of columns
# ---------------------------------------------------------------
@pytest.mark.parametrize("head", ["40\n", "z [um]\n40\n", "40\n0.25\n"])
def test_a_number_of_points_is_no_height(tmp_path: Path, head: str) -> None:
    refused(tmp_path, head + column(), "'40'", "number of points", pitch=1e-6, units="um")


@pytest.mark.parametrize("head", ["40;2\n", "40;\n", "40;0.25\n"])
@pytest.mark.parametrize("keys", [{}, {"sort": True}, {"fill": "drop"}], ids=str)
def test_a_number_of_points_is_no_point(tmp_path: Path, head: str, keys: dict) -> None:
    refused(tmp_path, head + table(), "number of points", units="um", **keys)
    refused(tmp_path, head + table(X + 100), "number of points", units="um", **keys)


def test_a_lone_number_of_points_is_a_header_and_descending_positions_are_points(
    tmp_path: Path,
) -> None:
    for between in (";", " "):
        same(read(tmp_path, "40\n" + table(between=between), units="um", fill="drop"), (1e-6, 1e-6))
    down = np.arange(N)[::-1]
    assert read(tmp_path, UM + table(down)).heights == pytest.approx(1e-6 * Z[::-1])


@pytest.mark.parametrize("name", ["Depth", "Tiefe", "Profondeur", "Глубина", "深度"])
def test_depths_are_inverted_only_if_the_option_invert_says_so(tmp_path: Path, name: str) -> None:
    content = f"x [um];{name} [nm]\nremark\n{table()}"
    refused(tmp_path, content, name, "invert = true", "invert = false")
    same(read(tmp_path, content, invert=True), (1e-6, -1e-9))
    same(read(tmp_path, content, invert=False), (1e-6, 1e-9))
    assert "upside down" in read(tmp_path, content, invert=True).history[1]
    refused(tmp_path, content, "invert = 1", invert=1)


def test_a_table_on_its_side_is_refused_with_this_reason(tmp_path: Path) -> None:
    rows = [[f"{v:.3f}" for v in values] for values in (X, Z)]
    for between in (";", "\t", " ", ","):
        plain = "".join(between.join(row) + "\n" for row in rows)
        named = "".join(between.join(r) + "\n" for r in (["x", *rows[0]], ["z", *rows[1]]))
        for content in (plain, named):
            refused(tmp_path, content, "2 rows of 40 numbers", "transposed", units="um")
    refused(
        tmp_path, ";".join(rows[1]), "a row of 40 numbers", "transposed", units="um", pitch=1e-6
    )


def test_repeated_positions_are_refused_with_a_hint_to_heights_and_a_pitch(tmp_path: Path) -> None:
    coarse = UM + table(np.round(0.4 * X[:12] / 0.25), Z[:12])
    refused(tmp_path, coarse, "repeated", "heights alone", "pitch = 3.63636e-07")
    assert read(tmp_path, coarse, columns=[1], pitch=4e-7).heights == pytest.approx(1e-6 * Z[:12])


def test_a_missing_column_is_named_with_the_columns_of_the_file(tmp_path: Path) -> None:
    refused(tmp_path, UM + table(), "there is no column 7, only columns 0 to 1", columns=[0, 7])
    refused(
        tmp_path, UM + table(), "there is no column 2, only columns 0 to 1", columns=[2], pitch=1e-6
    )
    refused(tmp_path, UM + table(), "line 1 has 'x [um]', 'z [um]'", columns=["x", "height"])


def test_positions_that_may_count_the_points_cause_a_warning(tmp_path: Path) -> None:
    rows = "".join(f"{i + 1};{z}\n" for i, z in enumerate(Z))
    warned(tmp_path, rows, "may count the points", "columns = [1] and pitch", units="um")
    assert read(tmp_path, rows, units="um", columns=[0, 1]).x.size == N
    refused(tmp_path, f"No.;z\nremark\n{rows}", "'No.'", "count the points", units="um")


# Heights that are missing
# -----------------------------------------------------------------------------
@pytest.mark.parametrize(
    "word",
    [
        "#N/A", "#NV", "#DIV/0!", "1.#INF", "-1.#IND", "1.#QNAN", "No Data", "n.a.", "?", ".",
        "-nan(ind)",
    ],
)  # fmt: skip
@pytest.mark.parametrize("between", [";", "  "])
def test_usual_words_for_no_height_are_known(tmp_path: Path, word: str, between: str) -> None:
    content = UM + table(z=holed(word), between=between)
    refused(tmp_path, content, "line 7", "missing", 'fill = "drop"')
    assert read(tmp_path, content, fill="drop").heights == pytest.approx(1e-6 * np.delete(Z, HOLES))
    assert read(tmp_path, content, fill="drop", missing=word).x.size == N - 3


@pytest.mark.parametrize("word", ["OVR", "Out of range", "(no) (sig"])
@pytest.mark.parametrize("between", [";", "  "])
def test_other_words_are_refused_with_a_hint_to_the_option_missing(
    tmp_path: Path, word: str, between: str
) -> None:
    content = UM + table(z=holed(word), between=between)
    refused(tmp_path, content, "line 7", "use missing = ")
    assert read(tmp_path, content, fill="drop", missing=word).x.size == N - 3


def test_a_word_in_the_second_row_does_not_make_the_first_a_header(tmp_path: Path) -> None:
    refused(tmp_path, UM + table(z=[Z[0], "OVR", "OVR", *Z[3:]]), "line 3", "'OVR'")


@pytest.mark.parametrize("missing", ["-32768", "-32768.0", " -32768", -32768, -32768.0])
@pytest.mark.parametrize("written", ["-32768", "-32768.000"])
def test_a_number_that_marks_missing_heights_may_be_given_as_text(
    tmp_path: Path, missing: object, written: str
) -> None:
    read_back = read(tmp_path, UM + table(z=holed(written)), missing=missing, fill="drop")
    assert read_back.heights == pytest.approx(1e-6 * np.delete(Z, HOLES))


@pytest.mark.parametrize("word", ["-32768", "No Data", "Out of range"])
def test_the_option_missing_is_the_same_in_a_scene_and_in_the_command(
    tmp_path: Path, word: str
) -> None:
    path = tmp_path / "trace.csv"
    path.write_text(UM + table(z=holed(word)), encoding="utf-8")
    scene = tmp_path / "a.toml"
    keys = ["--missing", word, "--fill", "drop", "--scene", str(scene)]
    result = CliRunner().invoke(cli.main, ["trace", str(path), *keys])
    assert result.exit_code == 0 and "3 of 40 heights are missing" in result.output
    assert contact.load_scene(scene).profile.x.size == N - 3


def test_heights_before_a_missing_one_are_no_header(tmp_path: Path) -> None:
    content = "z [um]\n" + column([Z[0], "#N/A", *Z[2:]])
    keys = {"pitch": 2.5e-7, "fill": "drop"}
    assert read(tmp_path, content, **keys).heights == pytest.approx(1e-6 * np.delete(Z, 1))
    other = "z [um]\n" + column([0.1, "OVR", *Z[2:]])
    warned(tmp_path, other, "line 2", "set missing", pitch=2.5e-7)
    assert read(tmp_path, other, missing="OVR", **keys).x.size == N - 1


def test_no_line_of_a_column_of_heights_is_dropped_silently(tmp_path: Path) -> None:
    lost = "z [um]\n" + column([*Z[:7], "#N/A", *Z[8:]])
    refused(tmp_path, lost, "line 9", "missing", pitch=1e-6)
    refused(tmp_path, lost.replace("#N/A", "# bad"), "a comment", "line 9", pitch=1e-6)


# Dropouts and spikes
# ----------------------------------------------------------------------------
SPIKE = 40 * float(np.ptp(Z))


@pytest.mark.parametrize(
    ("offset", "changed"),
    [
        (12.0, {5: 0.0, 6: 0.0, 20: 0.0}),
        (12.0, {7: 0.0}),
        (3.0, {10: 0.0, 11: 0.0, 12: 0.0, 13: 0.0}),
        (0.0, {5: -32768.0, 6: 32767.0, 20: -32768.0}),
        (0.0, {17: SPIKE}),
        (0.0, {0: -SPIKE}),
        (0.0, {39: SPIKE}),
        (0.0, {8: SPIKE, 9: SPIKE + 1, 30: SPIKE - 1}),
    ],
)
def test_dropouts_and_spikes_cause_a_warning(
    tmp_path: Path, offset: float, changed: dict[int, float]
) -> None:
    heights = [changed.get(i, offset + z) for i, z in enumerate(Z.tolist())]
    warned(tmp_path, "x [mm];z [um]\n" + table(z=heights), "missing")


def wave(x: np.ndarray) -> np.ndarray:
    return np.cos(9 * x)


@pytest.mark.parametrize(
    "shape",
    [
        wave,
        lambda x: np.round(wave(x), 1),
        lambda x: np.sign(np.sin(60 * x)),
        lambda x: np.sign(np.sin(60 * x)) + 1e-3 * np.cos(1e4 * x),
        lambda x: np.exp(-(((x - 0.5) / 0.01) ** 2)),
        lambda x: np.sqrt(np.maximum(0, 0.04 - (x - 0.5) ** 2)),
        lambda x: np.floor(5 * x),
        lambda x: (8 * x) % 1,
        lambda x: np.minimum(np.cos(40 * x), 0.2),
        lambda x: -np.abs(x - 0.5),
        lambda x: (2 * x - 1) ** 9,
        lambda x: np.random.default_rng(2).lognormal(size=x.size),
        lambda x: np.cos(np.pi / 2 * np.arange(x.size)) - 0.3 * x,
    ],
)  # fmt: skip
def test_real_shapes_cause_no_warning(tmp_path: Path, shape) -> None:
    x = np.linspace(0.0, 1.0, 400)
    read(tmp_path, "x [mm];z [um]\n" + table(x, shape(x)))


# Messages
# -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("content", "keys"),
    [
        ("x [" + "w" * 500 + "];z [um]\n" + table(), {}),
        ("x [um];Depth " + "w" * 500 + "\n" + table(), {"units": "um"}),
        (UM + table() + "z" * 5000 + "\n", {}),
        (UM + table(), {"columns": ["x", "y" * 500]}),
        ("\n".join(";".join(f"{i}.{k}" for k in range(90)) for i in range(40)), {"units": "um"}),
        (UM + table(z=holed("w" * 500)), {}),
    ],
    ids=range(6),
)  # fmt: skip
def test_messages_stay_short_whatever_the_file_holds(
    tmp_path: Path, content: str, keys: dict
) -> None:
    refused(tmp_path, content, **keys)
