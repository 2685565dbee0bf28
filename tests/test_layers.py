"""Who may import whom: `contact` stands on the public names of `sie`; within each package files stand in an order."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

# From the ground up: a file imports from lines above its own only. A new profile or interaction has its line already.
SIE = """
    ends chebyshev kernels exact tree kept
    far zones
    piecewise
    local_spline
    zone_spline
    conditions steps
    beyond
    breaks
    equation valleys
    gap_steps lazy modes near_jumps neighbours
    crowded
    assemble checks
    fast folding hierarchical krylov
    field many
    everywhere
    density
    cuts local rounding
    solve
    holes
    pierced
    released
    apart
    free_boundary
    __init__
"""
CONTACT = """
    errors interrupts units dips extrema profiles.derive profiles.trigonometric
    axisymmetric.derived axisymmetric.quadrature checks grid lazy
    axisymmetric.lattices axisymmetric.profiles
    axisymmetric.direct axisymmetric.lattice_sums
    axisymmetric.neighbours
    axisymmetric.system
    axisymmetric.answer
    axisymmetric.refine
    axisymmetric.spot
    axisymmetric.levels
    axisymmetric.__init__
    registry spectrum terminal trace_text trace_units inverse.product
    trace_header
    trace_readings
    trace_file
    measured
    profiles.base exact.base
    profiles.declared profiles.* exact.*
    exact.localized search testing inverse.profile
    exact.__init__ profiles.__init__ inverse.designed
    paper.one_zone paper.principle paper.two_zones
    paper.parabola paper.wave paper.wedge
    paper.__init__
    inverse.random
    inverse.__init__
    interactions.base
    interactions.*
    turning operator
    interactions.declared
    problem interactions.__init__ scene
    bounded fields planning single scene_file answer leaning
    certificate conjugate sampling validity
    relief
    full zone_loads
    export framing plateau plotting topology
    accuracy first_order gapped proposals solution
    gap_certificate
    gap_search
    by_load
    solver
    compare paths
    compare_plot figures.base
    figures.*
    figures.__init__
    bench.clock bench.truth bench.harmonics bench.hyperbola bench.power bench.one_gap bench.one_zone bench.truncated bench.formulations
    bench.cases bench.extremes.base
    bench.precision bench.scaling bench.extremes.large bench.extremes.loads bench.extremes.neighbours
    bench.extremes.shapes
    bench.extremes.__init__
    bench.peers bench.stability
    bench.report
    bench.machine bench.plots bench.required
    bench.run
    bench.__init__
    __init__
    cli
    __main__
"""
HEAVY = ("numba", "matplotlib", "xarray", "click", "rich", "pydantic", "scipy.interpolate", "scipy.optimize", "pandas")


def order(text: str) -> list[list[str]]:
    return [line.split() for line in text.strip().splitlines()]


def modules(package: str) -> dict[str, Path]:
    """Name below the package, such as `profiles.base` or `exact.__init__`, to file."""
    folder = ROOT / package
    return {".".join(f.relative_to(folder).with_suffix("").parts): f for f in sorted(folder.rglob("*.py"))}


def rank(name: str, lines: list[list[str]]) -> int:
    """The line a module stands on: the one that names it, else the one whose pattern fits."""
    named = [i for i, line in enumerate(lines) if name in line]
    fits = [i for i, line in enumerate(lines) if any("*" in p and fnmatchcase(name, p) for p in line)]
    assert len(named) <= 1, f"{name} is named twice"
    assert named or len(fits) == 1, f"{name} has no line in the order of files, or more than one"
    return (named or fits)[0]


def imports(tree: ast.AST) -> Iterator[tuple[str, str | None]]:
    """(module, name or None) of every import that runs; those for type checkers alone do not."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        if isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            yield from ((node.module or "", alias.name) for alias in node.names)
        else:
            yield from imports(node)


def targets(package: str, names: dict[str, Path], tree: ast.AST) -> Iterator[str]:
    """Modules of the same package that a file imports."""
    for module, name in imports(tree):
        if module != package and not module.startswith(package + "."):
            continue
        below = module[len(package) + 1 :]
        choices = [f"{below}.{name}", f"{below}.{name}.__init__", below, f"{below}.__init__"]
        yield next(c for c in (choice.lstrip(".") for choice in choices) if c in names)


def upward(package: str, text: str) -> list[str]:
    names, lines = modules(package), order(text)
    return [
        f"{package}.{name} imports {package}.{other}"
        for name, file in names.items()
        for other in targets(package, names, ast.parse(file.read_text(encoding="utf-8")))
        if rank(other, lines) >= rank(name, lines)
    ]


@pytest.mark.parametrize(("package", "text"), [("sie", SIE), ("contact", CONTACT)])
def test_no_file_imports_from_its_own_line_or_above_it(package: str, text: str) -> None:
    assert upward(package, text) == []


def test_an_order_turned_upside_down_is_noticed() -> None:
    assert upward("sie", "\n".join(SIE.strip().splitlines()[::-1]))


@pytest.mark.parametrize(("package", "text"), [("sie", SIE), ("contact", CONTACT)])
def test_the_order_names_no_file_that_is_not_there(package: str, text: str) -> None:
    names = modules(package)
    assert [p for line in order(text) for p in line if not any(fnmatchcase(name, p) for name in names)] == []


def test_the_engine_never_imports_contact() -> None:
    for name, file in modules("sie").items():
        found = {module.partition(".")[0] for module, _ in imports(ast.parse(file.read_text(encoding="utf-8")))}
        assert "contact" not in found, name


def test_contact_uses_only_what_the_engine_exports() -> None:
    public = set(ast.literal_eval(_all_of(ROOT / "sie" / "__init__.py")))
    for name, file in modules("contact").items():
        tree = ast.parse(file.read_text(encoding="utf-8"))
        for module, what in imports(tree):
            assert not module.startswith("sie."), f"contact.{name} imports {module}"
            assert module != "sie" or what is None or what in public, f"contact.{name} imports sie.{what}"
        used = {
            node.attr
            for node in ast.walk(tree)
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "sie"
        }
        assert used <= public, f"contact.{name} uses {used - public} of sie"


def _all_of(file: Path) -> ast.expr:
    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return node.value
    raise AssertionError(f"{file} has no __all__")


def test_imports_stand_at_the_head_of_files() -> None:
    local = [
        f"{package}.{name}.{function.name}"
        for package in ("sie", "contact")
        for name, file in modules(package).items()
        if (package, name) != ("contact", "lazy")
        for function in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(function, (ast.FunctionDef, ast.AsyncFunctionDef))
        and any(isinstance(node, (ast.Import, ast.ImportFrom)) for node in ast.walk(function))
    ]
    assert local == []


def test_only_the_lazy_files_import_by_name() -> None:
    for package in ("sie", "contact"):
        for name, file in modules(package).items():
            if name != "lazy":
                text = file.read_text(encoding="utf-8")
                assert "import_module" not in text and "__import__" not in text, f"{package}.{name}"


def loaded_after(code: str) -> set[str]:
    """Heavy packages that are in sys.modules after the code has run in a fresh interpreter."""
    report = f"\nimport sys; print(*[m for m in {HEAVY!r} if m in sys.modules])"
    command = [sys.executable, "-c", code + report]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True, stdin=subprocess.DEVNULL)
    return set(run.stdout.split())


def test_importing_contact_loads_nothing_heavy() -> None:
    assert loaded_after("import contact") == set()


def test_a_wave_is_solved_without_anything_heavy() -> None:
    scene = "contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e11, contact.Periodic(), mean_pressure=1e8)"
    assert loaded_after(f"import contact; contact.solve({scene}).pressure(0.0)") == set()


def test_what_is_heavy_is_noticed_where_it_is_used() -> None:
    assert "scipy.optimize" in loaded_after("import contact, scipy.optimize")
