"""The user's folders of cache, settings and session, and the kinds of cached files."""

import os
import shutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from platformdirs import user_cache_path, user_config_path, user_state_path

from vrut_lite.errors import UserError

NAME = "vrut_lite"
# Kinds of cached files, by the names that belong to them; another folder is its own kind, and other
# files beside the folders are facts of this machine.
_KINDS = {
    "kernels": ("kernels", "compiling.lock"),
    "tables": ("tables_of_formulas", "time_zones"),
    "light": ("light_maps", "still_light"),
    "layouts": ("layouts", "cut_texels"),
    "skies": ("first_skies",),
}
_MEANINGS = {
    "kernels": "compiled numerical code, by version; unused for 30 days it is removed",
    "tables": "tables of formulas and time zones",
    "light": "rays and light of scenes",
    "layouts": "light maps' places on surfaces",
    "skies": "first skies of a session",
    "manual": "the manual's pages",
    "machine": "this machine's renderers",
}
_MACHINE = "machine"
_KIND_OF = {name: kind for kind, names in _KINDS.items() for name in names}


class CachedKind(NamedTuple):
    """Cached files of one kind.

    Attributes:
        name: of the kind.
        meaning: a phrase; empty for a folder of somebody else's module.
        paths: files and folders of the cache folder.
        files: number of files in them.
        size_bytes: of these files.
    """

    name: str
    meaning: str
    paths: tuple[Path, ...]
    files: int
    size_bytes: int


def cache_folder() -> Path:
    """The user's cache folder; missing files are computed when they are needed."""
    return user_cache_path(NAME)


def settings_folder() -> Path:
    """The folder of presets."""
    return user_config_path(NAME)


def session_folder() -> Path:
    """The folder of the last session, the recent files and the window's layout."""
    return user_state_path(NAME)


def cached_kinds() -> list[CachedKind]:
    """Kinds of files in the cache folder, the largest first."""
    by_kind: dict[str, list[Path]] = {}
    with suppress(OSError):
        for path in sorted(cache_folder().iterdir()):
            is_folder = path.is_dir() and not path.is_symlink()
            other = path.name if is_folder else _MACHINE
            by_kind.setdefault(_KIND_OF.get(path.name, other), []).append(path)
    found = [_measured(kind, tuple(paths)) for kind, paths in by_kind.items()]
    return sorted(found, key=lambda kind: -kind.size_bytes)


def size_of(folder: Path) -> tuple[int, int]:
    """Number and bytes of the files in a folder; zeros if it is missing."""
    sizes = list(_sizes(folder))
    return len(sizes), sum(sizes)


def clear_cache(kinds: list[CachedKind]) -> int:
    """Remove cached files; the bytes that became free.

    Raises:
        UserError: a file or folder cannot be removed.
    """
    for kind in kinds:
        for path in kind.paths:
            try:
                if path.is_dir() and not path.is_symlink():
                    shutil.rmtree(path)
                else:
                    path.unlink(missing_ok=True)
            except FileNotFoundError:  # Another process removes files too.
                continue
            except OSError as error:
                raise UserError(
                    f"cannot remove {error.filename or path}: {error.strerror}"
                ) from error
    return sum(kind.size_bytes for kind in kinds)


def size_text(size_bytes: int) -> str:
    """A size in kB, MB or GB."""
    for unit, scale in (("GB", 1e9), ("MB", 1e6)):
        if size_bytes >= scale:
            return f"{size_bytes / scale:.1f} {unit}"
    return f"{size_bytes / 1e3:.0f} kB"


def tilde(path: Path) -> str:
    """A path with the home folder as `~`, which a bug report need not name."""
    home = Path(os.path.expanduser("~"))
    if path.is_relative_to(home) and path != home:
        return f"~/{path.relative_to(home).as_posix()}"
    return str(path)


def _measured(kind: str, paths: tuple[Path, ...]) -> CachedKind:
    sizes = [size for path in paths for size in _sizes(path)]
    return CachedKind(kind, _MEANINGS.get(kind, ""), paths, len(sizes), sum(sizes))


def _sizes(path: Path) -> Iterator[int]:
    """Sizes of a file, or of all files in a folder; what vanishes meanwhile is left out."""
    if path.is_file() or path.is_symlink():
        with suppress(OSError):
            yield path.lstat().st_size
        return
    for folder, _, files in os.walk(path):
        for file in files:
            with suppress(OSError):
                yield os.lstat(os.path.join(folder, file)).st_size
