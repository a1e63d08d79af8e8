"""Scene files are strangers: what they name stays in their own folder, and nothing is too big.

Every byte a scene asks for comes through `SceneFolder`, so that what was checked and what is
used are the same thing.
"""

import base64
import binascii
import re
from pathlib import Path
from urllib.parse import unquote_to_bytes

from trimesh.resolvers import Resolver

MAX_FILE_BYTES = 2**30
_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]*):")
_NETWORK = {"http", "https", "ftp", "ftps", "ws", "wss", "sftp"}


class SceneFileError(ValueError):
    """What is wrong with a scene file and what to do; the path is added by `load_scene`."""


def read_whole_file(path: Path) -> bytes:
    """The bytes of a regular file of at most `MAX_FILE_BYTES`.

    Raises:
        SceneFileError: if it cannot be read or is too large.
    """
    try:
        size = path.stat().st_size
        if size > MAX_FILE_BYTES:
            raise SceneFileError(
                f"{path.name} has {size} bytes, more than the limit of {MAX_FILE_BYTES}; "
                "split or simplify it"
            )
        return path.read_bytes()
    except OSError as fault:
        raise SceneFileError(
            f"{path.name} cannot be read ({fault.strerror}); check its permissions"
        ) from fault


class SceneFolder(Resolver):
    """Serves files inside one folder and nothing else; also trimesh's resolver.

    trimesh swallows a resolver's exceptions, hence the first one is kept in `fault`.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self.fault: SceneFileError | None = None

    def locate(self, name: str) -> Path:
        """The path of a file named relative to the folder; it need not exist.

        Raises:
            SceneFileError: if the name leads out of the folder or to the network.
        """
        _refuse_foreign(name)
        try:
            path = (self.folder / name).resolve()
        except (OSError, ValueError, RuntimeError) as fault:
            raise SceneFileError(
                f"it names {_short(name)}, which no file can be called; mend the reference"
            ) from fault
        if not path.is_relative_to(self.folder):
            raise SceneFileError(
                f"it names {_short(name)}, a link that leaves the scene's folder; "
                "put the file itself beside the scene"
            )
        return path

    def get(self, key: str) -> bytes:
        """The bytes of a file in the folder.

        Raises:
            SceneFileError: if it is outside the folder, missing, unreadable or too large.
        """
        try:
            return self._get(key)
        except SceneFileError as fault:
            self.fault = self.fault or fault
            raise

    def _get(self, name: str) -> bytes:
        path = self.locate(name)
        try:
            there = path.is_file()
        except OSError:
            there = False
        if not there:
            raise SceneFileError(
                f"it names {_short(name)}, which is missing; put that file beside the scene"
            )
        return read_whole_file(path)

    def get_uri(self, uri: str) -> bytes:
        """The bytes behind a glTF URI: a base64 data URI, or a percent-encoded relative path."""
        return _decode_data_uri(uri) if _is_data_uri(uri) else self.get(_decode_path(uri))

    def check_uri(self, uri: str) -> None:
        """Raise if a glTF URI leads out of the folder; whether the file is there is not asked."""
        if not _is_data_uri(uri):
            self.locate(_decode_path(uri))

    def write(self, name: str, data: bytes) -> None:
        """Refused: loading a scene writes nothing."""
        raise SceneFileError(f"it asks to write {_short(name)}; a scene is only read")

    def namespaced(self, namespace: str) -> "SceneFolder":
        """The same checks for a folder inside this one."""
        return type(self)(self.locate(namespace))

    def keys(self) -> list[str]:
        """Names of the files directly in the folder."""
        return sorted(path.name for path in self.folder.iterdir() if path.is_file())


def _is_data_uri(uri: str) -> bool:
    """Whether the URI carries its data in itself."""
    return uri[:5].lower() == "data:"


def _decode_path(uri: str) -> str:
    _refuse_foreign(uri)
    try:
        return unquote_to_bytes(uri).decode()
    except UnicodeDecodeError as fault:
        raise SceneFileError(
            f"it names {_short(uri)}, which is not UTF-8; rename that file"
        ) from fault


def _refuse_foreign(name: str) -> None:
    """Raise for names that are not plain relative paths downwards with forward slashes."""
    scheme = _SCHEME.match(name)
    if scheme and scheme[1].lower() in _NETWORK:
        problem = "which lies on the network; save that file beside the scene"
    elif scheme:
        problem = "which is not a path relative to the scene; name the file alone"
    elif "\\" in name:
        problem = "which has a backslash; write its path with forward slashes"
    elif not name.strip() or "\0" in name:
        problem = "which is no file name; mend the reference"
    elif name.startswith(("/", "~")) or ".." in name.split("/"):
        problem = "which leads out of the scene's folder; put that file beside the scene"
    else:
        return
    raise SceneFileError(f"it names {_short(name)}, {problem}")


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
    """A name fit for one line of text, also when it is a hostile one."""
    text = ascii(name)
    return text if len(text) <= 80 else text[:76] + "...'"
