"""Rules of imports: `contact` uses only public names of `sie`, and the folders of each package
have an order.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Collection, Iterator
from functools import cache
from pathlib import Path

import pytest

import contact
import sie
from tests.interpreter import loaded_after_each

ROOT = Path(__file__).parents[1]

# The folders of each package, and the files beside them, from the bottom up. A file imports only
# from its own folder and from those to the left of it.
ORDER = {
    "sie": """
        loops basis trees jumps equation density dense fast states graded second_kind slits ends results reasons solver
        __init__
    """,
    "contact": """
        errors interrupts extras runtime model testing reference exact inverse axisymmetric
        formulation inside verify solution closed search localized adhesion tangential plastic solver
        sweeps slip derivatives design explorer __init__ paper studies commands __main__
    """,
    "contact.search": "options topology grid context feasibility strategies find refine __init__",
}
# The only files that import modules by name: they import heavy modules when a scene needs them.
ON_DEMAND = {"contact.extras", "sie.basis.lazy"}
HEAVY = (
    "numba",
    "matplotlib",
    "xarray",
    "click",
    "rich",
    "pydantic",
    "scipy.interpolate",
    "scipy.optimize",
    "pandas",
    "panel",
    "bokeh",
)


def modules(package: str) -> dict[str, Path]:
    """Files by their names in the package, such as `model.scene` or `model.__init__`."""
    folder = ROOT / package.replace(".", "/")
    return {
        ".".join(f.relative_to(folder).with_suffix("").parts): f
        for f in sorted(folder.rglob("*.py"))
    }


@cache
def parsed(file: Path) -> ast.Module:
    """The syntax tree of a file."""
    return ast.parse(file.read_text(encoding="utf-8"))


@cache
def imports(tree: ast.AST) -> tuple[tuple[str, str | None], ...]:
    """(module, name or None) of every import, including imports for type checkers."""
    return tuple(_imports(tree))


def _imports(tree: ast.AST) -> Iterator[tuple[str, str | None]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            yield from ((node.module or "", alias.name) for alias in node.names)


def targets(package: str, names: dict[str, Path], tree: ast.AST) -> Iterator[str]:
    """Modules of the same package that a file imports."""
    for module, name in imports(tree):
        if module != package and not module.startswith(package + "."):
            continue
        below = module[len(package) + 1 :]
        choices = [f"{below}.{name}", f"{below}.{name}.__init__", below, f"{below}.__init__"]
        yield next(c for c in (choice.lstrip(".") for choice in choices) if c in names)


def upward(package: str, text: str) -> list[str]:
    """Imports from a folder that is to the right of the file's own folder in `text`."""
    names, rooms = modules(package), text.split()
    return [
        f"{package}.{name} imports {package}.{other}"
        for name, file in names.items()
        for other in targets(package, names, parsed(file))
        if rooms.index(other.partition(".")[0]) > rooms.index(name.partition(".")[0])
    ]


def circles(package: str) -> list[str]:
    """Files whose imports form a cycle, and files that import such a file."""
    names = modules(package)
    below = {name: set(targets(package, names, parsed(file))) for name, file in names.items()}
    while ground := [name for name, others in below.items() if not others]:
        for name in ground:
            del below[name]
        for others in below.values():
            others.difference_update(ground)
    return sorted(below)


@pytest.mark.parametrize("package", ORDER)
def test_folders_import_downwards_only(package: str) -> None:
    assert upward(package, ORDER[package]) == []


@pytest.mark.parametrize("package", ORDER)
def test_the_order_names_every_folder_and_nothing_else(package: str) -> None:
    assert {name.partition(".")[0] for name in modules(package)} == set(ORDER[package].split())


@pytest.mark.parametrize("package", ORDER)
def test_imports_form_no_cycle(package: str) -> None:
    assert circles(package) == []


@pytest.mark.parametrize("package", ORDER)
def test_every_folder_has_a_docstring(package: str) -> None:
    for file in (ROOT / package.replace(".", "/")).rglob("__init__.py"):
        assert ast.get_docstring(parsed(file)), file


def test_an_order_turned_upside_down_is_noticed() -> None:
    assert upward("sie", " ".join(ORDER["sie"].split()[::-1]))


def test_the_engine_never_imports_contact() -> None:
    for name, file in modules("sie").items():
        found = {module.partition(".")[0] for module, _ in imports(parsed(file))}
        assert "contact" not in found, name


def test_contact_uses_only_what_the_engine_exports() -> None:
    public = set(ast.literal_eval(_all_of(ROOT / "sie" / "__init__.py")))
    for name, file in modules("contact").items():
        if name.startswith("studies."):
            continue  # they take the engine apart to measure it
        tree = parsed(file)
        for module, what in imports(tree):
            assert not module.startswith("sie."), f"contact.{name} imports {module}"
            assert module != "sie" or what is None or what in public, (
                f"contact.{name} imports sie.{what}"
            )
        used = {
            node.attr
            for node in ast.walk(tree)
            if isinstance(node, ast.Attribute)
            and isinstance(node.value, ast.Name)
            and node.value.id == "sie"
        }
        assert used <= public, f"contact.{name} uses {used - public} of sie"


def _all_of(file: Path) -> ast.expr:
    for node in parsed(file).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return node.value
    raise AssertionError(f"{file} has no __all__")


def test_imports_stand_at_the_head_of_files() -> None:
    local = [
        f"{package}.{name}.{function.name}"
        for package in ORDER
        for name, file in modules(package).items()
        for function in ast.walk(parsed(file))
        if isinstance(function, (ast.FunctionDef, ast.AsyncFunctionDef))
        and any(isinstance(node, (ast.Import, ast.ImportFrom)) for node in ast.walk(function))
    ]
    assert local == []


# Largest number of code lines of a file, formatted by `ruff format`. Blank lines, comments and
# docstrings do not count.
LONGEST = 500


def code_lines(text: str, tree: ast.Module) -> int:
    """Lines of a file that are neither blank nor comments nor docstrings."""
    documented: set[int] = set()
    for node in ast.walk(tree):
        if (
            isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef))
            and ast.get_docstring(node, clean=False) is not None
        ):
            documented |= set(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
    lines = enumerate(text.splitlines(), 1)
    return sum(
        1
        for number, line in lines
        if number not in documented and line.strip() and not line.lstrip().startswith("#")
    )


def test_files_stay_short() -> None:
    files = [file for package in ORDER for file in modules(package).values()]
    texts = {file: file.read_text(encoding="utf-8") for file in files}
    # A file with fewer lines in total need not be parsed.
    long = [file for file, text in texts.items() if text.count("\n") > LONGEST]
    assert [file for file in long if code_lines(texts[file], parsed(file)) > LONGEST] == []
    text = '"""One.\n\nTwo."""\n# no\n\nx = 1\n'
    assert code_lines(text, ast.parse(text)) == 1


def test_few_files_import_by_name() -> None:
    for package in ORDER:
        for name, file in modules(package).items():
            if f"{package}.{name}" not in ON_DEMAND:
                text = file.read_text(encoding="utf-8")
                assert "import_module" not in text and "__import__" not in text, f"{package}.{name}"


WAVE = "contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e11, contact.Periodic(), mean_pressure=1e8)"
SERIES = "contact.Scene(contact.Fourier(1e-4, [-1e-6, 2e-7]), 1e11, contact.Periodic(), mean_pressure=1e8)"
# Statements that a new interpreter runs one after the other.
STEPS = {
    "import": "import contact",
    "wave": f"wave = contact.solve({WAVE}); wave.max_pressure",
    "pressure": "wave.pressure(0.0)",
    "gap": "wave.gap(0.0)",
    "series": f"series = contact.solve({SERIES}); series.gap(0.0), series.energy",
    "table": "series._repr_html_()",
    "heavy": "import scipy.optimize",
}


def loaded_after(step: str, names: Collection[str] = HEAVY) -> set[str]:
    """Those modules of `names` (by default heavy ones) that are in sys.modules after a step."""
    return dict(zip(STEPS, loaded_after_each(*STEPS.values()), strict=True))[step] & set(names)


def test_importing_contact_loads_nothing_heavy() -> None:
    assert loaded_after("import") == set()


def test_a_wave_is_solved_without_anything_heavy() -> None:
    assert loaded_after("pressure") == set()


def test_loading_a_heavy_module_is_noticed() -> None:
    assert "scipy.optimize" in loaded_after("heavy")


def test_contact_asks_no_type_of_the_engine_s_states_and_densities() -> None:
    """No file of `contact` has a test of types such as isinstance(x, sie.State).
    A rate by a parameter may be a `sie.MovedDensity`, which has a smooth part of its own.
    """
    kinds = [kind for kind in sie.__all__ if kind.endswith(("State", "Density"))]
    kinds.remove("MovedDensity")
    for name, file in modules("contact").items():
        if not name.startswith("studies."):
            text = file.read_text(encoding="utf-8")
            asked = re.findall(r"isinstance\([^)]*\bsie\.(\w+)", text)
            assert not set(asked) & set(kinds), name


def test_every_name_of_the_engine_is_found_where_it_is_said_to_be() -> None:
    """`sie._HOMES` has the module from which each public name is loaded. It agrees with
    `__all__`, with the imports for type checkers, and with the modules themselves.
    """
    homes = {name: module for module, names in sie._HOMES.items() for name in names.split()}
    assert set(homes) == set(sie.__all__) <= set(dir(sie))
    tree = parsed(ROOT / "sie" / "__init__.py")
    assert {name: module for module, name in imports(tree) if name in homes} == homes
    assert all(
        getattr(sie, name) is getattr(sys.modules[module], name) for name, module in homes.items()
    )


def test_a_wave_is_solved_without_the_search_for_ends() -> None:
    engine = ("sie.solver", "sie.states.solve", "sie.ends.newton", "sie.slits.system")
    assert loaded_after("wave", engine) == set()
    assert loaded_after("gap", engine)


def test_a_series_is_solved_without_tables_pictures_or_what_belongs_to_a_tension() -> None:
    late = (
        "contact.solution.export",
        "contact.solution.plotting",
        "html",
        "contact.testing",
        "contact.adhesion.deformed_profile",
        "contact.derivatives.result",
    )
    assert loaded_after("series", late) == set()
    assert loaded_after("table", late) >= set(late[1:3])


def test_every_name_of_contact_that_is_loaded_late_is_found_where_it_is_said_to_be() -> None:
    """`contact._HOMES` has the module of each public name that is loaded on demand. It agrees
    with the imports for type checkers and with the modules, and importing `contact` loads none
    of them.
    """
    homes = {name: module for module, names in contact._HOMES.items() for name in names.split()}
    assert set(homes) < set(contact.__all__)
    tree = parsed(ROOT / "contact" / "__init__.py")
    assert {name: module for module, name in imports(tree) if name in homes} == homes
    assert all(
        getattr(contact, name) is getattr(sys.modules[module], name)
        for name, module in homes.items()
    )
    assert loaded_after("import", homes.values()) == set()
