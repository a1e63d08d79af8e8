"""Access to the files of a scene: only inside its folder, only up to a limited size.

Scene files may come from strangers. Every byte is read through `SceneFolder`, so that the bytes
that were checked are the bytes that are used.
"""

import base64
import binascii
import posixpath
import re
from pathlib import Path
from urllib.parse import unquote_to_bytes

from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.scene_file_error import SceneFileError, UnreadFile

MAX_FILE_BYTES = 2**30
_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]*):")
_OUTSIDE = "outside the scene's folder"
_NETWORK = {"http", "https", "ftp", "ftps", "ws", "wss", "sftp"}


class SceneFolder:
    """Reads files inside one folder only, each once, under whatever names it is referred to."""

    def __init__(self, folder: Path, budget: SceneBudget) -> None:
        self.folder = folder.resolve()
        self.budget = budget
        self._files: dict[tuple[int, int], bytes] = {}
        self._by_uri: dict[str, bytes] = {}

    def read(self, path: Path) -> bytes:
        """The bytes of a regular file of at most `MAX_FILE_BYTES`.

        Raises:
            SceneFileError: if it cannot be read, is too large, or does not fit the budget.
        """
        try:
            status = path.stat()
            identity = (status.st_dev, status.st_ino)
            if identity not in self._files:
                self._admit(status.st_size, path.name)
                with path.open("rb") as file:
                    self._files[identity] = file.read(status.st_size)
            return self._files[identity]
        except OSError as fault:
            raise SceneFileError(
                f"{path.name} cannot be read ({fault.strerror}); check its permissions"
            ) from fault

    def _admit(self, size: int, name: str) -> None:
        if size > MAX_FILE_BYTES:
            raise SceneFileError(
                f"{name} has {size} bytes, more than the limit of {MAX_FILE_BYTES}; "
                "split or simplify it"
            )
        self.budget.take(size, f"the file {_short(name)}")
        self.budget.find(size)

    def locate(self, name: str) -> Path:
        """The path of a file named relative to the folder; it need not exist.

        Raises:
            UnreadFile: if the name leads out of the folder or to the network.
        """
        _refuse_foreign(name)
        try:
            path = (self.folder / name).resolve()
        except (OSError, ValueError, RuntimeError) as fault:
            raise _no_file_name(name) from fault
        if not path.is_relative_to(self.folder):
            raise UnreadFile(
                f"it names {_short(name)}, a link that leaves the scene's folder; "
                "put the file itself beside the scene",
                _OUTSIDE,
            )
        return path

    def has(self, name: str) -> bool:
        """Whether a file in the folder has this name; not of one that leads out of it."""
        try:
            return self.locate(name).is_file()
        except (SceneFileError, OSError):
            return False

    def get(self, name: str) -> bytes:
        """The bytes of a file in the folder.

        Raises:
            UnreadFile: if it is outside the folder or missing.
            SceneFileError: if it is unreadable or too large.
        """
        path = self.locate(name)
        try:
            there = path.is_file()
        except OSError as fault:
            raise _no_file_name(name) from fault
        if not there:
            raise UnreadFile(
                f"it names {_short(name)}, which is missing; put that file beside the scene",
                "missing",
            )
        return self.read(path)

    def get_uri(self, uri: str) -> bytes:
        """The bytes behind a glTF URI: a base64 data URI, or a percent-encoded relative path.

        The same file or URI gives the same object, so that callers can reuse what they made of it.

        Raises:
            SceneFileError: if it is damaged, or as `get` does.
        """
        if uri not in self._by_uri:
            if _is_data_uri(uri):
                self.budget.take(len(uri), "a data URI in it")
                self._by_uri[uri] = _decode_data_uri(uri)
            else:
                self._by_uri[uri] = self.get(_decode_path(uri))
        return self._by_uri[uri]


def _is_data_uri(uri: str) -> bool:
    """Whether the URI contains its data."""
    return uri[:5].lower() == "data:"


def _decode_path(uri: str) -> str:
    _refuse_foreign(uri)
    try:
        return unquote_to_bytes(uri).decode()
    except UnicodeDecodeError as fault:
        raise UnreadFile(
            f"it names {_short(uri)}, which is not UTF-8; rename that file", "not a name in UTF-8"
        ) from fault


def _refuse_foreign(name: str) -> None:
    """Raise for names other than relative paths inside the folder with forward slashes."""
    scheme = _SCHEME.match(name)
    if not name.strip() or "\0" in name:
        raise _no_file_name(name)
    why = _OUTSIDE
    if scheme and scheme[1].lower() in _NETWORK:
        problem = "which lies on the network; save that file beside the scene"
        why = "on the network"
    elif scheme:
        problem = "which is not a path relative to the scene; name the file alone"
    elif "\\" in name:
        problem = "which has a backslash; write its path with forward slashes"
        why = "a path with backslashes"
    elif name.startswith(("/", "~")) or posixpath.normpath(name).startswith(".."):
        problem = "which leads out of the scene's folder; put that file beside the scene"
    else:
        return
    raise UnreadFile(f"it names {_short(name)}, {problem}", why)


def _no_file_name(name: str) -> UnreadFile:
    message = f"it names {_short(name)}, which no file can be called; mend the reference"
    return UnreadFile(message, "not a name of a file")


def _decode_data_uri(uri: str) -> bytes:
    head, comma, body = uri.partition(",")
    if not comma or not head.lower().endswith(";base64"):
        raise SceneFileError("a data URI in it is not base64; export the scene again")
    try:
        return base64.b64decode(unquote_to_bytes(body), validate=True)
    except (binascii.Error, ValueError) as fault:
        raise SceneFileError(
            f"a data URI in it is damaged ({fault}); export the scene again"
        ) from fault


def _short(name: str) -> str:
    """A name escaped and shortened for one line of text."""
    text = ascii(name)
    return text if len(text) <= 80 else text[:76] + "...'"
