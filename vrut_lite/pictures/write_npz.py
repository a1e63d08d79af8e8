"""Arrays as numpy's .npz, the same bytes for the same content."""

import os
import zipfile
from collections.abc import Mapping
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from vrut_lite.pictures.picture_array import Metadata
from vrut_lite.write_atomic import atomic_output

# The oldest date that a zip archive can hold: when a file was made is no part of its content.
_NO_DATE = (1980, 1, 1, 0, 0, 0)


def write_npz(
    path: str | os.PathLike[str],
    arrays: Mapping[str, NDArray],
    metadata: Metadata | None = None,
) -> None:
    """Write named arrays, and metadata as arrays of no dimension, sorted by name, compressed.

    Raises:
        ValueError: a name occurs in both, or an array holds Python objects.
        UserError: the file cannot be written.
    """
    members: dict[str, NDArray] = {
        key: np.asarray(value) for key, value in (metadata or {}).items()
    }
    if twice := sorted(members.keys() & arrays.keys()):
        raise ValueError(f"'{twice[0]}' names both an array and a metadata entry")
    members.update(arrays)
    with atomic_output(path) as beside:
        archive = zipfile.ZipFile(beside, "w")
        try:
            for name in sorted(members):
                entry = zipfile.ZipInfo(f"{name}.npy", date_time=_NO_DATE)
                entry.compress_type = zipfile.ZIP_DEFLATED
                with archive.open(entry, "w", force_zip64=True) as stream:
                    np.lib.format.write_array(stream, members[name], allow_pickle=False)
            archive.close()
        finally:
            _abandon(archive)


def _abandon(archive: zipfile.ZipFile) -> None:
    """Close the file of an archive that is not closed yet, because its writing has failed.

    Between two members zipfile may refuse to close, also when it is collected, and so may a file
    on a full disk: that refusal would take the place of the interrupt or the first error.
    """
    stream, archive.fp = archive.fp, None
    if stream is not None:
        with suppress(OSError):
            stream.close()
