"""Packages of somebody else: as they lie in an environment, and as wheels."""

import base64
import hashlib
import os
import subprocess
import sys
import sysconfig
import zipfile
from contextlib import contextmanager

from vrut_lite.package_facts import installed_points

MODULE = """
from vrut_lite.kernel.module import Manifest, Module


class Foreign(Module):
    manifest = Manifest(name="{name}", title="Foreign", version="1")
"""
RAISING = "1 / 0\n"
EXITING = "import sys\n\nsys.exit(3)\n"
ENDING = "import os\n\nos._exit(3)\n"
# Rows of metadata that all of them have.
_FACTS = "Author: Ada\nLicense-Expression: BSD-3-Clause\n"


def files_of(name, code=MODULE, version="1.0", requires=(), points=None, package=None):
    """Names and texts of a package's files; without `code` its python file is missing."""
    package = package or name
    if points is None:
        points = {"vrut_lite.modules": {name: f"{package}:Foreign"}}
    rows = [
        line
        for group, named in points.items()
        for line in (f"[{group}]", *(f"{point} = {value}" for point, value in named.items()))
    ]
    info = f"{name}-{version}.dist-info"
    metadata = f"Metadata-Version: 2.4\nName: {name}\nVersion: {version}\n{_FACTS}" + "".join(
        f"Requires-Dist: {requirement}\n" for requirement in requires
    )
    files = {
        f"{info}/METADATA": metadata,
        f"{info}/WHEEL": "Wheel-Version: 1.0\nGenerator: tests\nRoot-Is-Purelib: true\n"
        "Tag: py3-none-any\n",
        f"{info}/entry_points.txt": "\n".join(rows) + "\n",
    }
    if code is not None:
        files[f"{package}.py"] = code.replace("{name}", name)
    return files


def put(folder, name, *arguments, **facts):
    """A package in a folder that is on the path, as an installer leaves it there."""
    for place, text in files_of(name, *arguments, **facts).items():
        path = folder / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def wheel_of(folder, name, *arguments, version="1.0", **facts):
    """A wheel of a package."""
    files = files_of(name, *arguments, version=version, **facts)
    record = f"{name}-{version}.dist-info/RECORD"
    rows = []
    for place, text in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(text.encode()).digest()).rstrip(b"=")
        rows.append(f"{place},sha256={digest.decode()},{len(text.encode())}")
    files[record] = "\n".join([*rows, f"{record},,"]) + "\n"
    path = folder / f"{name}-{version}-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        for place, text in files.items():
            archive.writestr(place, text)
    return path


@contextmanager
def on_path(folder):
    """The folder's packages are installed in this process."""
    known = set(sys.modules)
    sys.path.append(str(folder))
    installed_points.cache_clear()
    try:
        yield
    finally:
        sys.path.remove(str(folder))
        installed_points.cache_clear()
        for name in set(sys.modules) - known:
            if str(getattr(sys.modules[name], "__file__", "")).startswith(str(folder)):
                del sys.modules[name]


class ScratchEnvironment:
    """A virtual environment that also sees this one's packages; pip changes it alone."""

    def __init__(self, folder):
        self.folder = folder
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
        scripts = "Scripts" if os.name == "nt" else "bin"
        self.python = folder / scripts / ("python.exe" if os.name == "nt" else "python")
        scheme = sysconfig.get_paths("venv", {"base": str(folder), "platbase": str(folder)})
        outer = sysconfig.get_path("purelib")
        (self.site / "outer.pth").write_text(f"import site; site.addsitedir({outer!r})\n")
        assert self.site == type(folder)(scheme["purelib"])

    @property
    def site(self):
        """Where its packages lie."""
        (found,) = self.folder.rglob("site-packages")
        return found

    def vrut_lite(self, *arguments, answer="", **variables):
        """Run the command line in it."""
        return self.run(
            "-c", "from vrut_lite.cli import main; main()", *arguments, answer=answer, **variables
        )

    def run(self, *arguments, answer="", **variables):
        """Run its Python, without an index and without a network."""
        return subprocess.run(
            [self.python, *map(str, arguments)],
            input=answer,
            env={**os.environ, "PIP_NO_INDEX": "1", "PIP_NO_BUILD_ISOLATION": "0", **variables},
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
        )
