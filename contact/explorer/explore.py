"""`contact.explore`: a scene with sliders, in a notebook or in a browser."""

import tomllib
from os import PathLike
from pathlib import Path
from typing import Any

from contact.errors import SceneError
from contact.explorer.presets import PRESETS
from contact.explorer.server import Given, Page
from contact.model.scene import Scene
from contact.model.scene_file import load_scene, scene_from_tables
from contact.solver import tolerance


def explore(
    scene: Scene | str | PathLike[str] | None = None, tol: float = 1e-8, port: int | None = None
) -> Page:
    """Open a page with sliders for the numbers of a scene.

    The page shows both bodies, the pressure, the stress below the surface, the load curve and the
    stated error.

    A notebook displays the returned object; elsewhere its `show()` opens a browser, and `contact
    explore SCENE` serves the same page. The page is served to this machine only.

    Parameters
    ----------
    scene : Scene, str, path or None
        The scene or the name of a scene file; None: a wave.
    tol : float
        Largest stated error while no slider moves.
    port : int or None
        Port of the page; None: one that is free.

    Returns
    -------
    Page
        With `address`, `show()` and `close()`.

    Raises
    ------
    SceneError
        If the scene cannot be read or the port is not free. Later errors are shown on the page.

    Examples
    --------
    >>> import contact
    >>> profile = contact.Sinusoid(1e-6, 1e-4)
    >>> wave = contact.Scene(profile, 1e11, contact.Periodic(), mean_pressure=1e9)
    >>> page = contact.explore(wave)
    >>> page.address.startswith("http://127.0.0.1:")
    True
    >>> page.close()
    """
    return Page(_given(scene), tolerance(tol), port)


def _given(scene: Any) -> Given:
    """The scene, the tables of its file and the file's folder.
    If `scene` is None, a preset wave is taken.
    """
    if scene is None:
        tables = tomllib.loads(PRESETS["wave"].text)
        return Given(scene_from_tables(tables), tables, preset="wave")
    if isinstance(scene, Scene):
        return Given(scene)
    if not isinstance(scene, (str, PathLike)):
        raise SceneError.of("scene", scene, "a contact.Scene, or the name of a scene file")
    read = load_scene(scene)
    tables = tomllib.loads(Path(scene).read_text(encoding="utf-8"))
    return Given(read, tables, Path(scene).parent)
