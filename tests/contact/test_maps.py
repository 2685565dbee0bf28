"""Lines of a map of heights: all file formats give the same trace."""

import io

import numpy as np
import pytest

import contact

NX, NY = 24, 7
X, Y = np.meshgrid(0.5e-6 * np.arange(NX), 2e-6 * np.arange(NY), indexing="ij")
Z = 1e-9 * (3 * np.cos(9e5 * X) + np.sin(2e5 * Y + 0.3) * np.sin(3e5 * X))
ROWS = np.column_stack([part.ravel() for part in (1e6 * X, 1e6 * Y, 1e9 * Z)])
SHUFFLED = ROWS[np.random.default_rng(7).permutation(len(ROWS))]
LINES = [
    ({"line": 3}, X[:, 3], Z[:, 3]),
    ({"line": 5, "along": "y"}, Y[5], Z[5]),
    ({"line": [[0.5e-6, 0.0], [0.5e-6, 12e-6]]}, None, None),
]


def text(rows, header="x [um]; y [um]; z [nm]", delimiter=";"):
    """A text stream with a header and these rows."""
    stream = io.StringIO()
    np.savetxt(stream, rows, fmt="%.15g", delimiter=delimiter, header=header, comments="")
    return io.StringIO(stream.getvalue())


def netcdf(tmp_path):
    """A netCDF file of SurfaceTopography with the map."""
    package = pytest.importorskip("SurfaceTopography")
    sizes = NX * 0.5, NY * 2.0
    path = tmp_path / "map.nc"
    package.Topography(1e6 * Z, sizes, unit="um").to_netcdf(path)
    return path


@pytest.mark.parametrize(("place", "x", "z"), LINES)
@pytest.mark.parametrize("rows", [ROWS, SHUFFLED], ids=["sorted", "shuffled"])
def test_a_line_of_a_text_map_is_the_trace_of_its_points(place, x, z, rows):
    trace = contact.read_trace(text(rows), **place)
    if x is None:
        assert np.ptp(trace.x) == pytest.approx(12e-6, rel=1e-12)
        return
    assert trace.x == pytest.approx(x, abs=1e-18)
    assert trace.heights == pytest.approx(z, abs=1e-20)


@pytest.mark.parametrize("place", [place for place, _, _ in LINES])
def test_text_and_netcdf_give_the_same_trace(place, tmp_path):
    written, saved = (contact.read_trace(one, **place) for one in (text(ROWS), netcdf(tmp_path)))
    assert written.x == pytest.approx(saved.x, rel=1e-9, abs=1e-18)
    assert written.heights == pytest.approx(saved.heights, rel=1e-9, abs=1e-18)


def test_missing_points_of_a_map_count_as_not_measured():
    rows = np.delete(ROWS, [3 + 4 * NY, 3 + 5 * NY], axis=0)
    with pytest.raises(contact.SceneError, match="fill"):
        contact.read_trace(text(rows), line=3)
    trace = contact.read_trace(text(rows), line=3, fill="drop")
    assert trace.x == pytest.approx(np.delete(X[:, 3], [4, 5]), abs=1e-18)


def moved(row, by):
    rows = ROWS.copy()
    rows[row, 0] += by
    return rows


@pytest.mark.parametrize(
    ("rows", "keys", "said"),
    [
        (ROWS, {}, r"x, y and z of a map, set line"),
        (ROWS, {"along": "y"}, r"line = None"),
        (ROWS, {"line": NY}, rf"0 to {NY - 1}"),
        (ROWS, {"line": 0, "pitch": 1e-6}, r"pitch"),
        (ROWS, {"line": 0, "channel": 0}, r"channel"),
        (ROWS, {"line": 0, "columns": [0, 1]}, r"three columns"),
        (ROWS, {"line": 0, "columns": [0, 1, 1]}, r"three columns"),
        (moved(40, 0.2), {"line": 0}, r"line 42: the values of x are not evenly spaced"),
        (np.vstack([ROWS, ROWS[5]]), {"line": 0}, rf"line {len(ROWS) + 2}: this line repeats"),
        (ROWS[:NY], {"line": 0}, r"two values of x"),
        (np.column_stack([ROWS, ROWS[:, 2]]), {"line": 0}, r"x, y and the heights"),
    ],
)
def test_wrong_maps_and_keys_are_refused_with_the_reason(rows, keys, said):
    header = "" if rows.shape[1] == 4 else "x [um]; y [um]; z [nm]"
    with pytest.raises(contact.SceneError, match=said):
        contact.read_trace(text(rows, header), **keys)


def test_the_spreadsheet_of_a_roughness_tester_is_read(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    pytest.importorskip("SurfaceTopography")
    book = openpyxl.Workbook()
    data, certificate = book.active, book.create_sheet("Certificate")
    data.title, data["A1"], certificate["E2"] = "DATA", "Ra  0.5  um", "02/01/2024"
    other = tmp_path / "other.xlsx"
    book.save(other)
    certificate["E48"] = "0.8mm"
    heights = np.sin(np.arange(60) / 9)
    for i, height in enumerate(heights):
        data.cell(i + 1, 5, 0.5e-3 * (i + 1))
        data.cell(i + 1, 6, float(height))
    path = tmp_path / "tester.xlsx"
    book.save(path)
    trace = contact.read_trace(path)
    assert trace.heights == pytest.approx(1e-6 * heights, rel=1e-12)
    assert np.diff(trace.x) == pytest.approx(0.5e-6, rel=1e-9)
    with pytest.raises(contact.SceneError, match="Mitutoyo SurfTest"):
        contact.read_trace(other)
