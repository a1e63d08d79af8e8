"""Where Radiance (LBNL) is: the wheel `pyradiance` brings its programs."""

import importlib.util
import os
from pathlib import Path

from vrut_lite_lab.study.peers.peer import NotHere


def radiance_home() -> Path:
    """The folder with `bin` and `lib`.

    Raises:
        NotHere: it is not installed.
    """
    found = importlib.util.find_spec("pyradiance")
    if found is None or found.origin is None:
        raise NotHere("Radiance is not installed: pip install 'vrut-lite-lab[peers]'")
    return Path(found.origin).parent


def radiance_environment() -> dict[str, str]:
    """What its programs need to find each other."""
    home = radiance_home()
    path = f"{home / 'bin'}{os.pathsep}{os.environ.get('PATH', '')}"
    return {**os.environ, "PATH": path, "RAYPATH": f".{os.pathsep}{home / 'lib'}"}
