"""Reads an .npz that may be damaged or malicious: sizes are checked before memory is taken.

numpy allocates the size in an array's header without checking that the file is as large.
"""

import math
import zipfile
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def read_npz(source: IO[bytes], most_bytes: int) -> dict[str, NDArray[Any]]:
    """The arrays of an archive by name; arrays of objects are refused.

    Raises:
        ValueError: the archive is damaged, or its arrays are larger than `most_bytes`.
    """
    try:
        with zipfile.ZipFile(source) as archive:
            total = sum(info.file_size for info in archive.infolist())
            if total > most_bytes:
                raise ValueError(f"its arrays are {total:,} bytes, more than {most_bytes:,}")
            for info in archive.infolist():
                _check_size(archive, info)
        source.seek(0)
        with np.load(source, allow_pickle=False) as arrays:
            return {name: np.asarray(arrays[name]) for name in arrays.files}
    except ValueError:
        raise
    except Exception as error:  # zip, inflate and numpy's header parser raise many types.
        raise ValueError(f"it is no whole archive of arrays ({error})") from error


def _check_size(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> None:
    """Raise ValueError unless a member is as large as its header declares."""
    with archive.open(info) as member:
        version = npy.read_magic(member)
        if version not in _HEADERS:
            raise ValueError(f"{info.filename} is of version {version}")
        shape, _, dtype = _HEADERS[version](member)
        if dtype.hasobject or member.tell() + math.prod(shape) * dtype.itemsize != info.file_size:
            raise ValueError(f"{info.filename} does not hold what its header says")
