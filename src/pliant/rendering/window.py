"""The window that nobody sees: where pictures are drawn, on machines with and without a display."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from pliant.errors import MissingExtra, NoGraphics

WINDOW = "VTK_DEFAULT_OPENGL_WINDOW"
SOFTWARE_LIBRARIES = ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so")


@contextmanager
def plotter(size: tuple[int, int]) -> Iterator[Any]:
    """An off-screen PyVista plotter that is closed at the end.

    Raises
    ------
    MissingExtra
        PyVista is not installed.
    NoGraphics
        There is no driver to draw with.
    """
    pyvista = import_pyvista()
    with _headless():
        _require_driver()
        drawing = pyvista.Plotter(off_screen=True, window_size=list(size), lighting="none")
        try:
            yield drawing
        finally:
            drawing.close()


def import_pyvista() -> Any:
    """PyVista, or the advice to install it."""
    try:
        import pyvista
    except ImportError as error:
        raise MissingExtra("drawing pictures", "render") from error
    return pyvista


@contextmanager
def _headless() -> Iterator[None]:
    """Where there is no display, ask VTK for EGL at once: it would try X11 first and complain, or crash without it."""
    if not sys.platform.startswith("linux") or os.environ.get("DISPLAY") or WINDOW in os.environ:
        yield
        return
    os.environ[WINDOW] = "vtkEGLRenderWindow"
    try:
        yield
    finally:
        del os.environ[WINDOW]


def _require_driver() -> None:
    """VTK falls back to OSMesa, and dies in the act of drawing if that is not there either: look before it does."""
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (registers the kinds of windows)
    from vtkmodules.vtkCommonCore import vtkLogger
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)  # what it would say stands in the error below
    try:
        kind = vtkRenderWindow().GetClassName()
    finally:
        vtkLogger.SetStderrVerbosity(verbosity)
    if kind == "vtkOSOpenGLRenderWindow" and not any(map(_loads, SOFTWARE_LIBRARIES)):
        raise NoGraphics(
            "nothing to draw with: no display, no working EGL driver and no OSMesa library "
            "(on Debian or Ubuntu: apt-get install libegl1 libgl1-mesa-dri)"
        )


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
