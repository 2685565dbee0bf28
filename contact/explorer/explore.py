"""`contact.explore`: a scene with sliders, in a notebook or in a browser."""

import logging
import socket
import tomllib
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any

from contact.errors import SceneError
from contact.extras import require
from contact.model.interactions import Periodic
from contact.model.profiles import Sinusoid
from contact.model.scene import Scene
from contact.model.scene_file import load_scene
from contact.solver import tolerance

ADDRESS = "127.0.0.1"


def explore(scene: Scene | str | PathLike[str] | None = None, tol: float = 1e-8) -> Any:
    """A page with sliders for a scene.

    It shows surfaces, zones, pressure, load curve and stated error.

    A notebook displays the returned object; elsewhere its `show()` opens a browser, and `contact
    explore SCENE` serves the same page. It needs the extra `explore`.

    Parameters
    ----------
    scene : Scene, str, path or None
        The scene or the name of a scene file; None: a sine wave.
    tol : float
        Largest stated error of each frame.

    Returns
    -------
    panel.viewable.Viewable

    Raises
    ------
    SceneError
        If the scene cannot be read. Later errors are shown on the page.
    MissingExtra
        If Panel is not installed.

    Examples
    --------
    >>> import contact
    >>> profile = contact.Sinusoid(1e-6, 1e-4)
    >>> wave = contact.Scene(profile, 1e11, contact.Periodic(), mean_pressure=1e9)
    >>> page = contact.explore(wave)
    >>> type(page).__name__
    'Row'
    """
    page = require("contact.explorer.page")
    given = _given(scene)
    # In a notebook the page contains its own scripts, and loads none from the network.
    require("panel").extension(inline=True)
    return page.Explorer(given[0], tolerance(tol), *given[1:]).layout


def serve(
    scene: Scene | str | PathLike[str] | None,
    tol: float,
    port: int | None,
    ready: Callable[[str], None],
    show: bool,
) -> None:
    """Serve the page to this machine only, until an interrupt.

    Each browser tab has its own scene.

    port: None for a free one; ready: called with the page's address once it answers; show: whether
    a browser is opened.
    """
    page, panel = require("contact.explorer.page"), require("panel")
    given, tol = _given(scene), tolerance(tol)

    def make() -> Any:
        return page.Explorer(given[0], tol, *given[1:]).layout

    port = port or _free()
    # Only pages from these addresses may connect to the server.
    origins = [f"{ADDRESS}:{port}", f"localhost:{port}"]
    try:
        server = panel.serve(
            make,
            address=ADDRESS,
            port=port,
            websocket_origin=origins,
            title="contact",
            show=False,
            start=False,
            verbose=False,
        )
    except OSError as error:
        raise SceneError.of(
            "port", port, f"one that is free ({error.strerror or error})"
        ) from error
    # Without this, Bokeh would log every closed tab.
    logging.getLogger("bokeh").setLevel(logging.ERROR)
    server.start()
    address = f"http://{ADDRESS}:{port}/"
    ready(address)
    if show:
        server.show("/")
    try:
        server.io_loop.start()
    finally:
        server.stop()


def _free() -> int:
    """The number of a free port of this machine."""
    with socket.socket() as probe:
        probe.bind((ADDRESS, 0))
        return int(probe.getsockname()[1])


def _given(scene: Any) -> tuple[Scene, dict[str, Any] | None, Path]:
    """The scene, the tables of its file (None without a file), and the folder of the file."""
    if scene is None:
        scene = Scene(Sinusoid(1e-6, 1e-4), 1.1e11, Periodic(), mean_pressure=1.7e9)
    if isinstance(scene, Scene):
        return scene, None, Path()
    if not isinstance(scene, (str, PathLike)):
        raise SceneError.of("scene", scene, "a contact.Scene, or the name of a scene file")
    read = load_scene(scene)
    return read, tomllib.loads(Path(scene).read_text(encoding="utf-8")), Path(scene).parent
