"""Lines for a bug report: versions, machine, graphics and folders of this installation.

Paths name the home folder as `~`.
"""

import os
import platform
import sys
from collections.abc import Iterator
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, metadata, version
from pathlib import Path

from vrut_lite import __version__
from vrut_lite.bundled.places import PACKAGE, is_checkout
from vrut_lite.package_facts import HOST, packages_of_others
from vrut_lite.user_files import (
    cache_folder,
    session_folder,
    settings_folder,
    size_of,
    size_text,
    tilde,
)

# Packages whose versions decide what works, by the names on the index; optional ones come last.
_PACKAGES = (
    "numpy", "numba", "llvmlite", "scipy", "moderngl", "pyrender", "PyOpenGL", "pillow", "OpenEXR",
    "msgspec", "PySide6-Essentials", "pyqtgraph", "mitsuba", "usd-core", "ifcopenshell", "pvlib",
    "distributed", "av",
)  # fmt: skip
# Environment variables that choose a display, a driver or folders.
_PREFIXES = (
    "VRUT_LITE_", "QT_QPA_", "QT_SCALE_", "XDG_SESSION_TYPE", "WAYLAND_DISPLAY", "DISPLAY",
    "LIBGL_", "MESA_", "GALLIUM_", "NUMBA_", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME",
)  # fmt: skip


def about_text(graphics: str) -> str:
    """The lines of a bug report.

    Args:
        graphics: the renderer and its driver, or the reason for their lack.
    """
    return "\n".join(_lines(graphics))


def version_of(package: str) -> str:
    """An installed package's version, or "not installed"."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _lines(graphics: str) -> Iterator[str]:
    kind = "a checkout" if is_checkout() else "a wheel"
    yield f"vrut_lite {__version__}, {kind}, in {tilde(PACKAGE.parent)}"
    yield f"Python {platform.python_version()}, {tilde(Path(sys.executable))}"
    yield f"system: {platform.platform()}, {_processor()}, {os.cpu_count()} cores"
    yield f"graphics: {graphics}"
    for package in _PACKAGES:
        yield f"{package} {version_of(package)}"
    for facts in {facts.name: facts for facts in packages_of_others().values()}.values():
        yield f"module package: {facts.title}"
    for title, folder in (
        ("settings", settings_folder()),
        ("cache", cache_folder()),
        ("last session", session_folder()),
    ):
        yield f"{title}: {tilde(folder)}, {size_text(size_of(folder)[1])}"
    for name, value in sorted(os.environ.items()):
        if name.startswith(_PREFIXES):
            yield f"{name}={tilde(Path(value)) if value.startswith('/') else value}"
    yield f"licence: {', '.join(_licences())}"


def _licences() -> list[str]:
    """The licence and the files of notices, as the package's metadata name them."""
    try:
        facts = metadata(HOST)
    except PackageNotFoundError:
        return ["MIT"]
    expressions = facts.get_all("License-Expression") or ["MIT"]
    return [str(each) for each in (*expressions, *(facts.get_all("License-File") or []))]


def _processor() -> str:
    """The processor's name as the system has it."""
    with suppress(OSError), open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
