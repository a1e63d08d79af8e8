"""Runs a library without limits of memory and time in a separate process."""

import os
import subprocess
import sys
import tempfile
from typing import NamedTuple

import msgspec

from vrut_lite.memory_limit import VARIABLE
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.mesh_file import MeshFile
from vrut_lite.scene.process_limits import TIME_IS_UP
from vrut_lite.scene.scene_file_error import SceneFileError

# The process itself limits its CPU time; this ends one that waits.
_MOST_SECONDS = 3600


class MeshReader(NamedTuple):
    """A module that reads files, run as `python -m MODULE SUFFIX BYTES`.

    `library_bytes` is the address space of Python and the library before they read. `extra` is the
    extra of the distribution that installs the library.
    """

    module: str
    kind: str
    library_bytes: int
    extra: str


def read_apart(reader: MeshReader, suffix: str, data: bytes, budget: SceneBudget) -> MeshFile:
    """Returns a file's content, read by another process under the rest of the memory limit.

    Raises:
        SceneFileError: a package is missing, or the file is damaged or takes too much.
    """
    kind, room_bytes = reader.kind, budget.room_bytes
    command = [sys.executable, "-m", reader.module, suffix]
    with tempfile.TemporaryFile() as answer:
        try:
            done = subprocess.run(
                [*command, str(int(room_bytes) + reader.library_bytes)],
                input=data,
                stdout=answer,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
                check=False,
                timeout=_MOST_SECONDS,
            )
            took_too_long = done.returncode in TIME_IS_UP
        except subprocess.TimeoutExpired:
            took_too_long = True
        if took_too_long:
            raise SceneFileError(f"its {kind} takes too long to read; simplify it")
        size = answer.seek(0, os.SEEK_END)
        if done.returncode != 0 or size == 0:
            raise SceneFileError(
                f"its {kind} ends the program that reads it: it is damaged, or takes more than the "
                f"{room_bytes / 2**30:.1f} GiB that are left of the limit; export it again, or "
                f"raise {VARIABLE}"
            )
        budget.take(size, f"the content of the {kind}")
        answer.seek(0)
        file = msgspec.msgpack.decode(answer.read(), type=MeshFile)
    if file.lacks_memory:
        raise SceneFileError(
            f"its {kind} takes more than {room_bytes / 2**30:.1f} GiB to read, which is left of "
            f"the limit; simplify it, or raise {VARIABLE}"
        )
    if file.lacks_library:
        raise SceneFileError(
            f"it is {kind}, and a Python package to read it is missing: "
            f"`pip install 'vrut-lite[{reader.extra}]'`, or import it into Blender and export it "
            "as glTF"
        )
    if file.fault:
        raise SceneFileError(f"its {kind} is damaged ({ascii(file.fault)[1:-1]}); export it again")
    return file
