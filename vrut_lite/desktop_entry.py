"""A desktop's entry for the window: menu entry, icon, and the type of project files (XDG).

Files go into the user's data folder ($XDG_DATA_HOME). The type covers `*.vrut.toml` alone: other
TOML files keep their program. A project of any other name opens by the command and by *Open with*.
"""

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from vrut_lite import operating_system
from vrut_lite.bundled.places import PACKAGE
from vrut_lite.errors import UserError
from vrut_lite.write_atomic import atomic_output, make_folder

PROJECT_TYPE = "application/x-vrut-lite-project"
_NAME = "vrut-lite"
_ICONS = {
    "scalable": "vrut-lite.svg",
    "48x48": "vrut-lite_48.png",
    "256x256": "vrut-lite_256.png",
}
_DATA = PACKAGE / "app" / "data"
_ENTRY = Path("applications") / f"{_NAME}.desktop"
_TYPE = Path("mime") / "packages" / f"{_NAME}.xml"
_SCENE_TYPES = ("model/gltf-binary", "model/gltf+json", "model/obj")
# Programs that a desktop has to read new files; each is called with a folder of the data folder.
_READERS = (("update-desktop-database", "applications"), ("update-mime-database", "mime"))
_READER_TIMEOUT_S = 60
# Characters that have a meaning within the quotes of a command (Desktop Entry Specification 1.5).
_QUOTED = str.maketrans({sign: f"\\{sign}" for sign in '"`$\\'})


def install_entry() -> list[Path]:
    """Write the entry, the icons and the type, and let the desktop read them; the files.

    Raises:
        UserError: the window cannot be started here, or the folder takes no files.
    """
    entry = _entry(_command()).encode()
    contents = {_ENTRY: entry, _TYPE: _type().encode()}
    contents |= {_icon_place(size): (_DATA / file).read_bytes() for size, file in _ICONS.items()}
    folder = _data_folder()
    for place, content in contents.items():
        file = folder / place
        make_folder(file.parent)
        with atomic_output(file) as beside:
            beside.write_bytes(content)
    _tell_desktop(folder)
    return [folder / place for place in contents]


def remove_entry() -> list[Path]:
    """Remove what `install_entry` wrote; the files that were there.

    Raises:
        UserError: a file cannot be removed.
    """
    folder = _data_folder()
    places = (_ENTRY, _TYPE, *map(_icon_place, _ICONS))
    there = [folder / place for place in places if (folder / place).exists()]
    for file in there:
        try:
            file.unlink()
        except OSError as error:
            raise UserError(f"cannot remove {file}: {error.strerror}") from error
    if there:
        _tell_desktop(folder)
    return there


def _data_folder() -> Path:
    if operating_system.NAME in ("win32", "darwin"):
        raise UserError("desktop entries are for Linux and its like: here start vrut-lite run")
    named = os.environ.get("XDG_DATA_HOME", "")
    # A relative path is invalid by the Base Directory Specification.
    return Path(named) if os.path.isabs(named) else Path.home() / ".local" / "share"


def _icon_place(size: str) -> Path:
    suffix = Path(_ICONS[size]).suffix
    return Path("icons") / "hicolor" / size / "apps" / f"{_NAME}{suffix}"


def _command() -> Path:
    """The program that this process is, or the one beside its Python."""
    if find_spec("PySide6") is None:
        raise UserError("the window needs PySide6: pip install 'vrut-lite[app]'")
    own = Path(os.path.abspath(sys.argv[0]))
    for program in (own, Path(sys.executable).with_name(_NAME)):
        if program.name == _NAME and os.access(program, os.X_OK):
            return program
    raise UserError(
        f"there is no program {_NAME} beside {sys.executable}: install vrut_lite by pip, pipx or uv"
    )


def _entry(command: Path) -> str:
    """The desktop file; a backslash is doubled, as in all its values."""
    program = f'"{str(command).translate(_QUOTED)}"'.replace("\\", "\\\\").replace("%", "%%")
    plain = str(command).replace("\\", "\\\\")
    types = ";".join((PROJECT_TYPE, *_SCENE_TYPES))
    return f"""[Desktop Entry]
Type=Application
Name=vrut_lite
GenericName=Daylight for Scenes
Comment=Scenes under the sky of a place and an hour
Exec={program} run %f
TryExec={plain}
Icon={_NAME}
Terminal=false
Categories=Graphics;3DGraphics;
Keywords=sky;sun;daylight;radiance;glTF;architecture;
MimeType={types};
"""


def _type() -> str:
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<mime-info xmlns="http://www.freedesktop.org/standards/shared-mime-info">
  <mime-type type="{PROJECT_TYPE}">
    <comment>vrut_lite project</comment>
    <sub-class-of type="application/toml"/>
    <glob pattern="*.vrut.toml" weight="60"/>
    <icon name="{_NAME}"/>
  </mime-type>
</mime-info>
"""


def _tell_desktop(folder: Path) -> None:
    """Let the desktop read the files, where it has programs for that."""
    for program, part in _READERS:
        found = shutil.which(program)
        if found is not None and (folder / part).is_dir():
            try:
                subprocess.run(
                    [found, str(folder / part)],
                    check=False,
                    capture_output=True,
                    timeout=_READER_TIMEOUT_S,
                )
            except (OSError, subprocess.TimeoutExpired):  # It reads them at its next start.
                continue
