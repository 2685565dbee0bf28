"""A scene file gives the scene of the Python call; errors name the file, table and key."""

from __future__ import annotations

import textwrap

import numpy as np
import pytest

import contact

GOOD = {
    "profile": 'shape = "sinusoid"\namplitude = 1e-6\nperiod = 1e-4',
    "material": "E_star = 1.1e11",
    "interaction": 'model = "periodic"',
    "control": "mean_pressure = 2e7",
}


def write(folder, **tables):
    """The path of a scene file with the tables GOOD, some of them changed; None omits a table."""
    text = "\n".join(
        f"[{name}]\n{body}" for name, body in {**GOOD, **tables}.items() if body is not None
    )
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return path


def refused(path) -> str:
    with pytest.raises(contact.SceneError) as caught:
        contact.load_scene(path)
    assert str(path) in str(caught.value)
    return str(caught.value)


class TestWhatIsRead:
    def test_a_file_gives_the_scene_that_python_gives(self, tmp_path):
        profile = contact.Sinusoid(amplitude=1e-6, period=1e-4)
        expected = contact.Scene(
            profile, E_star=1.1e11, interaction=contact.Periodic(), mean_pressure=2e7
        )
        assert contact.load_scene(write(tmp_path)) == expected
        assert contact.load_scene(str(write(tmp_path))) == expected

    def test_a_perturbed_file_gives_another_scene(self, tmp_path):
        good = contact.load_scene(write(tmp_path))
        assert good != contact.load_scene(write(tmp_path, control="mean_pressure = 2.1e7"))

    @pytest.mark.parametrize(
        ("table", "expected"),
        [
            ("E1 = 210e9\nnu1 = 0.3", contact.E_star(210e9, 0.3)),
            ("E1 = 210e9\nnu1 = 0.3\nE2 = 3e9\nnu2 = 0.4", contact.E_star(210e9, 0.3, 3e9, 0.4)),
            ("E_star = 110000000000", 1.1e11),
        ],
    )
    def test_the_material_is_a_reduced_modulus_or_the_moduli_it_is_made_of(
        self, tmp_path, table, expected
    ):
        assert contact.load_scene(write(tmp_path, material=table)).E_star == expected

    def test_interactions_take_their_parameters(self, tmp_path):
        isolated = contact.load_scene(
            write(
                tmp_path, interaction='model = "isolated"\ndatum = 1e-3', control="approach = 1e-7"
            )
        )
        assert isolated.interaction == contact.Isolated(datum=1e-3)
        localized = contact.load_scene(
            write(
                tmp_path,
                interaction='model = "localized"\nclosure = "self-consistent"\nneighbours = 2',
            )
        )
        assert localized.interaction == contact.Localized(closure="self-consistent", neighbours=2)

    def test_lists_of_numbers_are_parameters_too(self, tmp_path):
        scene = contact.load_scene(
            write(
                tmp_path,
                profile='shape = "fourier"\nperiod = 1e-4\ncosine = [-1e-6, 0]\nsine = [0, 1e-7]',
            )
        )
        x = np.linspace(0, 1e-4, 7)
        expected = contact.Fourier(1e-4, cosine=[-1e-6, 0], sine=[0, 1e-7]).height(x)
        assert np.array_equal(scene.profile.height(x), expected)

    def test_a_measured_profile_is_found_beside_the_scene_file(self, tmp_path, monkeypatch):
        (tmp_path / "data").mkdir()
        x = np.linspace(0.0, 100.0, 33)
        rows = "\n".join(
            f"{a:.17g},{b:.17g}"
            for a, b in zip(x, np.cos(2 * np.pi * x / 100.0) + 0.3 * x, strict=True)
        )
        (tmp_path / "data" / "trace.csv").write_text(rows)
        path = write(
            tmp_path,
            profile='shape = "sampled"\nfile = "data/trace.csv"\ncolumns = [0, 1]\nunits = ["um", "nm"]\n'
            'detrend = "line"\nregrid = 33\ntaper = 0.1\nperiod = true',
        )
        monkeypatch.chdir("/")
        profile = contact.load_scene(path).profile
        expected = contact.Sampled.from_file(
            tmp_path / "data" / "trace.csv",
            columns=[0, 1],
            units=["um", "nm"],
            detrend="line",
            regrid=33,
            taper=0.1,
            period=True,
        )
        assert profile == expected
        assert profile.period == pytest.approx(100e-6, rel=1e-12)

    def test_a_profile_that_registers_itself_is_readable_at_once(self, tmp_path):
        from dataclasses import dataclass

        @contact.register_profile("test quartic")
        @dataclass(frozen=True)
        class Quartic(contact.Profile):
            scale: float

            def height(self, x):
                return self.scale * np.asarray(x) ** 4

        try:
            scene = contact.load_scene(
                write(
                    tmp_path,
                    profile='shape = "test quartic"\nscale = 2.0',
                    interaction='model = "isolated"',
                    control="load = 1",
                )
            )
            assert scene.profile == Quartic(2.0)
        finally:
            contact.model.registry.PROFILES.forget("test quartic")


class TestWhatIsRefused:
    def test_a_missing_file(self, tmp_path):
        assert "No such file" in refused(tmp_path / "none.toml")

    def test_a_folder(self, tmp_path):
        refused(tmp_path)

    @pytest.mark.parametrize(
        "content", [b"[profile\n", b"a = ", b"\xff\xfe\x00", b"[control]\n[control]\n"]
    )
    def test_what_is_not_toml(self, tmp_path, content):
        path = tmp_path / "broken.toml"
        path.write_bytes(content)
        assert "TOML" in refused(path)

    def test_an_empty_file_by_all_the_tables_it_lacks(self, tmp_path):
        path = tmp_path / "empty.toml"
        path.write_text("")
        message = refused(path)
        assert all(table in message for table in GOOD)

    @pytest.mark.parametrize("table", GOOD)
    def test_a_missing_table_by_name(self, tmp_path, table):
        assert f"[{table}]" in refused(write(tmp_path, **{table: None}))

    def test_a_key_in_place_of_a_table(self, tmp_path):
        path = tmp_path / "flat.toml"
        tables = "\n".join(f"[{name}]\n{body}" for name, body in GOOD.items() if name != "control")
        path.write_text(f"control = 3\n{tables}")
        assert "[control]" in refused(path)

    def test_an_unknown_table_with_the_nearest_one(self, tmp_path):
        message = refused(write(tmp_path, controls="load = 1"))
        assert "'controls'" in message and "'control'" in message

    @pytest.mark.parametrize(
        ("table", "body", "wrong", "nearest"),
        [
            (
                "profile",
                'shape = "sinusoid"\namplitud = 1e-6\nperiod = 1e-4',
                "amplitud",
                "amplitude",
            ),
            (
                "profile",
                'shape = "sinusiod"\namplitude = 1e-6\nperiod = 1e-4',
                "sinusiod",
                "sinusoid",
            ),
            ("profile", 'shape = "sampled"\nfile = "a.csv"\ncolumn = [0, 1]', "column", "columns"),
            ("material", "E_Star = 1.1e11", "E_Star", "E_star"),
            ("interaction", 'model = "localised"', "localised", "localized"),
            ("interaction", 'model = "localized"\nneighbors = 1', "neighbors", "neighbours"),
            (
                "interaction",
                'model = "localized"\nclosure = "firstorder"',
                "firstorder",
                "first-order",
            ),
            ("control", "mean_presure = 2e7", "mean_presure", "mean_pressure"),
        ],
    )
    def test_an_unknown_name_with_the_nearest_one_and_its_table(
        self, tmp_path, table, body, wrong, nearest
    ):
        message = refused(write(tmp_path, **{table: body}))
        assert f"[{table}]" in message and wrong in message and f"'{nearest}'" in message

    @pytest.mark.parametrize(
        ("table", "body", "missing"),
        [
            ("profile", "amplitude = 1e-6\nperiod = 1e-4", "shape"),
            ("profile", 'shape = "sinusoid"\nperiod = 1e-4', "amplitude"),
            ("interaction", "neighbours = 0", "model"),
            ("material", "nu1 = 0.3", "E1"),
            ("material", "E1 = 1e9", "nu1"),
            ("material", "E1 = 1e9\nnu1 = 0.3\nE2 = 1e9", "nu2"),
            ("material", "", "E_star"),
            ("control", "", "exactly one"),
            ("control", "load = 1\napproach = 1e-7", "exactly one"),
            ("material", "E_star = 1e9\nE1 = 1e9\nnu1 = 0.3", "E1"),
        ],
    )
    def test_what_is_missing_or_too_much_by_name(self, tmp_path, table, body, missing):
        message = refused(write(tmp_path, **{table: body}))
        assert f"[{table}]" in message and missing in message

    @pytest.mark.parametrize(
        ("table", "body", "field"),
        [
            ("profile", 'shape = "sinusoid"\namplitude = "1e-6"\nperiod = 1e-4', "amplitude"),
            ("profile", 'shape = "sinusoid"\namplitude = nan\nperiod = 1e-4', "amplitude"),
            ("profile", 'shape = "sinusoid"\namplitude = 1e-6\nperiod = -1e-4', "period"),
            ("profile", "shape = 3", "shape"),
            ("profile", 'shape = "sampled"\nfile = "none.csv"', "none.csv"),
            ("profile", 'shape = "sampled"\nfile = 3', "file"),
            ("material", "E_star = true", "E_star"),
            ("material", "E_star = inf", "E_star"),
            ("material", 'E1 = "steel"\nnu1 = 0.3', "E1"),
            ("interaction", 'model = ["periodic"]', "model"),
            ("interaction", 'model = "isolated"\ndatum = -1', "datum"),
            ("control", "mean_pressure = 1979-05-27", "mean_pressure"),
            ("control", "load = -1", "load"),
            ("control", "half_width = 1e-4", "half_width"),
        ],
    )
    def test_an_invalid_value_by_its_field(self, tmp_path, table, body, field):
        assert field in refused(write(tmp_path, **{table: body}))

    @pytest.mark.parametrize(
        ("table", "body", "said"),
        [
            ("profile", 'shape = "sinusiod"', "[profile] shape = 'sinusiod' is not known"),
            (
                "interaction",
                'model = "periodical"',
                "[interaction] model = 'periodical' is not known",
            ),
            (
                "profile",
                'shape = "parabola"\nradius = 1.0',
                "[interaction] model = 'periodic' is refused",
            ),
            ("control", "half_width = 1.0", "[control] half_width = 1.0 is refused"),
            ("control", "contact_fraction = 2.0", "[control] contact_fraction = 2.0 is refused"),
            ("control", "load = 1.0\ntilt = 1e-3", "[control] tilt = 0.001 is refused"),
            ("material", "E_star = -1.0", "[material] E_star = -1.0 is refused"),
        ],
    )
    def test_a_message_has_the_key_that_was_written(self, tmp_path, table, body, said):
        assert said in refused(write(tmp_path, **{table: body}))

    @pytest.mark.parametrize("path", [None, 3, b"scene.toml", [], {}, object], ids=str)
    def test_what_is_no_file_name(self, path):
        with pytest.raises(contact.SceneError, match="^path = .* the name of a scene file"):
            contact.load_scene(path)

    def test_an_impossible_file_name(self):
        with pytest.raises(contact.SceneError, match="cannot be read"):
            contact.load_scene("a\0b")

    @pytest.mark.parametrize("tables", [None, 3, "profile", ["profile"], b"x"], ids=str)
    def test_what_is_no_table_of_tables(self, tables):
        with pytest.raises(contact.SceneError, match="tables = .* a mapping"):
            contact.model.scene_file.scene_from_tables(tables)

    def test_the_error_keeps_the_field_and_the_value(self, tmp_path):
        path = write(
            tmp_path, profile=textwrap.dedent('shape = "sinusoid"\namplitude = -1.0\nperiod = 1e-4')
        )
        with pytest.raises(contact.SceneError) as caught:
            contact.load_scene(path)
        assert (caught.value.field, caught.value.value) == ("amplitude", -1.0)
