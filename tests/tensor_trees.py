"""Small files of tensor trees, written by each test from functions of directions."""

import numpy as np
from daylight_numbers.sky_cells import on_disc

_FORM = """<?xml version="1.0" encoding="UTF-8"?>
<WindowElement xmlns="http://windows.lbl.gov">
<WindowElementType>System</WindowElementType><FileType>BSDF</FileType>
<Optical><Layer><Material><Name>sample</Name><Manufacturer>none</Manufacturer></Material>
<DataDefinition><IncidentDataStructure>TensorTree{rank}</IncidentDataStructure></DataDefinition>
<WavelengthData><LayerNumber>System</LayerNumber><Wavelength unit="Integral">Visible</Wavelength>
<WavelengthDataBlock><WavelengthDataDirection>{side}</WavelengthDataDirection>
<AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringDataType>BTDF</ScatteringDataType>
<ScatteringData>{tree}</ScatteringData></WavelengthDataBlock></WavelengthData>
</Layer></Optical></WindowElement>
"""


def tree_xml(tree, rank, side="Transmission Front"):
    """The text of a file with one tree."""
    return _FORM.format(tree=tree, rank=rank, side=side)


def directions(at):
    """Unit vectors (..., 3) of places (..., 2) on the square."""
    x, y = on_disc(*np.moveaxis(2.0 * np.asarray(at) - 1.0, -1, 0))
    return np.stack([x, y, np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))], axis=-1)


def tree_of(function, rank, depth, grid=0, random=None):
    """A tree of a function of coordinates (N, rank), whose leaves lie `depth` halvings deep and
    have grids of 2^grid values an edge; with `random` some leaves are larger by one halving."""

    def node(corner, size, left):
        stops = random is not None and left == 1 and random.random() < 0.3
        if left == 0 or stops:
            inner = np.indices((1 << grid,) * rank).reshape(rank, -1).T
            values = function(corner + (inner + 0.5) * size / (1 << grid))
            return "{" + " ".join(f"{value:.7g}" for value in values) + "}"
        parts = (
            node(corner + np.array([n >> axis & 1 for axis in range(rank)]) * size / 2, size / 2,
                 left - 1)
            for n in range(1 << rank)
        )  # fmt: skip
        return "{" + "\n".join(parts) + "}"

    return node(np.zeros(rank), 1.0, depth)
