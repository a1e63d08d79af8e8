"""Write the Hosek-Wilkie coefficients that dynamic_skylight carries.

Run once, with the extra `ref` installed: python lab/vrut_lite_lab/extract_hosek_wilkie.py
Source: mitsuba/data/sunsky/sunsky_datasets.bin of the mitsuba wheel, whose fields are the
authors' own tables (their notice is in the module's data/LICENSE.hosek_wilkie).
"""

import struct
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vrut_lite_lab.checkout import ROOT

TARGET = ROOT / "modules" / "dynamic_skylight" / "data" / "hosek_wilkie.npz"
MAGIC = b"tensor_file\0"
FLOAT64 = 11
# sun_rad_rgb stays behind: its weights are not on the scale of the sky's tables.
FIELDS = (
    "sky_params_rgb",
    "sky_rad_rgb",
    "sky_params_spec",
    "sky_rad_spec",
    "sun_rad_spec",
    "sun_ld_spec",
)


def read_tensor_file(content: bytes) -> dict[str, NDArray[np.float64]]:
    """Every float64 field of a Mitsuba tensor file (little endian, unaligned data) by name."""
    if not content.startswith(MAGIC):
        raise ValueError("the file does not start as a Mitsuba tensor file does")
    position = len(MAGIC) + 2
    (count,) = struct.unpack_from("<I", content, position)
    position += 4
    fields = {}
    for _ in range(count):
        (length,) = struct.unpack_from("<H", content, position)
        name = content[position + 2 : position + 2 + length].decode()
        position += 2 + length
        dimensions, kind, offset = struct.unpack_from("<HBQ", content, position)
        position += 11
        shape = struct.unpack_from(f"<{dimensions}Q", content, position)
        position += 8 * dimensions
        if kind == FLOAT64:
            size = int(np.prod(shape))
            fields[name] = np.frombuffer(content, "<f8", size, offset).reshape(shape)
    return fields


def main() -> None:
    """Read the wheel's file and write the module's."""
    package = find_spec("mitsuba")
    if package is None or package.origin is None:
        raise SystemExit("mitsuba is not installed: pip install -e .[ref]")
    source = Path(package.origin).parent / "data" / "sunsky" / "sunsky_datasets.bin"
    fields = read_tensor_file(source.read_bytes())
    np.savez_compressed(TARGET, allow_pickle=False, **{name: fields[name] for name in FIELDS})


if __name__ == "__main__":
    main()
