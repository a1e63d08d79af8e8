"""Reads PLY and OFF in its own process, where memory and time are limited.

`python -m vrut_lite.scene.polygon_process SUFFIX BYTES` reads a file from standard input, takes at
most so much memory, and writes a `MeshFile` to standard output.
"""

from vrut_lite.scene.mesh_file import MeshFile
from vrut_lite.scene.off_file import read_off
from vrut_lite.scene.ply_file import read_ply
from vrut_lite.scene.process_limits import run_reader

# Seconds of CPU for any file and for each of its bytes; rows of mixed lists take 3e-7 a byte.
_SECONDS, _SECONDS_PER_BYTE = 60, 1e-5


def read(suffix: str, data: bytes) -> MeshFile:
    """The content of a file with this suffix.

    Raises:
        Damaged: the file is no such file, or ends early.
    """
    return read_ply(data) if suffix == ".ply" else read_off(data)


if __name__ == "__main__":
    run_reader(read, _SECONDS, _SECONDS_PER_BYTE)
