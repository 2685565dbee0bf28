"""The metadata of the package agree in all files, and the extras that messages name can be
installed.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml
from click.testing import CliRunner

import contact
from contact import extras
from contact.commands.cli import main

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
RECIPE = yaml.safe_load((ROOT / "conda" / "recipe.yaml").read_text(encoding="utf-8"))
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
CONTAINER = (ROOT / "Containerfile").read_text(encoding="utf-8")


def bounds(requirements: list[str]) -> dict[str, str]:
    """Lower bound of each package, under the name it has on conda-forge."""
    found = (re.match(r"([\w-]+) ?(.*)", line) for line in requirements)
    return {
        one[1].replace("matplotlib-base", "matplotlib"): one[2]
        for one in found
        if one and one[1] != "python"
    }


def test_recipe_and_citation_name_the_same_package_version_and_licence() -> None:
    assert RECIPE["context"]["name"] == PROJECT["name"]
    assert RECIPE["context"]["version"] == CITATION["version"] == PROJECT["version"]
    assert RECIPE["about"]["license"] == CITATION["license"] == PROJECT["license"]
    assert f">={RECIPE['context']['python_min']}" == PROJECT["requires-python"]


def test_the_recipe_needs_what_the_package_needs() -> None:
    assert bounds(RECIPE["requirements"]["run"]) == bounds(PROJECT["dependencies"])
    optional = bounds(
        [line for name in ("plot", "io") for line in PROJECT["optional-dependencies"][name]]
    )
    assert bounds(RECIPE["requirements"]["run_constraints"]) == optional
    assert RECIPE["build"]["python"]["entry_points"] == [
        f"{name} = {place}" for name, place in PROJECT["scripts"].items()
    ]


def test_all_brings_every_extra() -> None:
    lists = re.findall(r"\[([\w,-]+)\]", " ".join(PROJECT["optional-dependencies"]["all"]))
    brought = {name for names in lists for name in names.split(",")}
    assert brought == set(PROJECT["optional-dependencies"]) - {"all"}


def test_what_the_container_copies_is_there() -> None:
    for line in re.findall(r"^COPY (.*)$", CONTAINER, re.MULTILINE):
        assert all((ROOT / name).exists() for name in line.split()[:-1]), line
    (wanted,) = re.findall(r'"\.\[([\w,]+)\]"', CONTAINER)
    assert set(wanted.split(",")) <= set(PROJECT["optional-dependencies"])


@pytest.mark.parametrize("checkout", [True, False])
def test_the_message_for_a_missing_extra_fits_the_way_of_installation(
    checkout: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(extras, "SOURCE", ROOT if checkout else tmp_path)
    monkeypatch.setitem(extras.EXTRAS, "no_such_package", "plot")
    with pytest.raises(contact.MissingExtra) as told:
        extras.require("no_such_package")
    assert str(told.value).endswith(
        f"pip install -e '.[plot]' in {ROOT}" if checkout else "pip install 'sie-contact[plot]'"
    )


@pytest.mark.parametrize("other", [[], ["contact-forms"]])
def test_the_version_command_warns_of_another_package_with_the_import_name(
    other: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    metadata = extras.require("importlib.metadata")
    seen = {"contact": ["sie_contact", *other]}
    stand_in = SimpleNamespace(
        packages_distributions=lambda: seen, version=lambda name: PROJECT["version"]
    )
    require = extras.require
    monkeypatch.setattr(
        extras, "require", lambda name: stand_in if name == metadata.__name__ else require(name)
    )
    done = CliRunner().invoke(main, ["--version"])
    assert done.stdout == f"contact {PROJECT['version']}\n"
    told = "contact: warning: contact-forms is imported as `contact` too: keep one of them in an environment\n"
    assert done.stderr == (told if other else "")


def test_dir_of_the_package_shows_what_is_public_and_no_more() -> None:
    assert set(dir(contact)) == {*contact.__all__, "__version__"}
    assert all(hasattr(contact, name) for name in dir(contact))


def readme_as_shown(**changes: object) -> str:
    """The readme as a package index shows it: that in the metadata of the package, made by the
    build hook. `changes` are the address of the source and options of the hook.
    """
    metadata = pytest.importorskip("hatchling.metadata.core")
    manager = pytest.importorskip("hatchling.plugin.manager").PluginManager()
    config = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    if changes:
        config["project"]["urls"] = {"Source": changes.pop("source")}
        config["tool"]["hatch"]["metadata"]["hooks"]["custom"] |= changes
    core = metadata.ProjectMetadata(str(ROOT), manager, config).core
    assert core.readme_content_type == "text/markdown"
    return str(core.readme)


def without_code(text: str) -> str:
    return re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)


def test_public_modules_are_available_after_import_contact() -> None:
    names = "contact.testing.check_profile, contact.exact.HertzLine, contact.inverse.design, contact.paper, contact.axisymmetric"
    code = f"import contact; print({names})"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60, stdout=subprocess.DEVNULL)


def test_the_readme_of_an_index_has_no_link_that_leads_nowhere_and_names_files_that_are_there() -> (
    None
):
    page, shown = (ROOT / "README.md").read_text(encoding="utf-8"), readme_as_shown()
    assert [
        link
        for link in re.findall(r"\]\(([^)]+)\)", without_code(shown))
        if not re.match(r"https?://|#", link)
    ] == []
    named = re.findall(r"`((?:docs|examples)/[\w./-]+|[A-Z]+\.md)`", shown)
    linked = {
        link.partition("#")[0]
        for link in re.findall(r"\]\(([^)]+)\)", without_code(page))
        if not re.match(r"https?://|#", link)
    }
    assert linked <= set(named) and all((ROOT / name).exists() for name in linked)
    assert re.findall(r"^```.*?^```", shown, re.MULTILINE | re.DOTALL) == re.findall(
        r"^```.*?^```", page, re.MULTILINE | re.DOTALL
    )
    # The source archive contains the files to which the readme refers.
    included = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"][
        "hatch"
    ]["build"]["targets"]["sdist"]["include"]
    assert (
        all(f"/{name.partition('/')[0]}" in included for name in linked)
        and "/hatch_build.py" in included
    )
    assert f"sie_contact-{PROJECT['version']}.tar.gz" in shown


def test_with_an_address_of_its_source_the_readme_of_an_index_leads_there() -> None:
    files, images = "{source}/blob/v{version}/{path}", "{source}/raw/v{version}/{path}"
    shown = readme_as_shown(source="https://example.org/x/", files=files, images=images)
    at = f"https://example.org/x/blob/v{PROJECT['version']}"
    assert (
        f"[Quick start]({at}/docs/quickstart.md)" in shown
        and f"]({at}/docs/theory.md#errata)" in shown
    )
    assert f"](https://example.org/x/raw/v{PROJECT['version']}/docs/images/limited.png)" in shown
    assert "tar.gz" not in shown
