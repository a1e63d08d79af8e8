"""Small files of LBNL's Window XML, written by each test."""

import numpy as np
from daylight_numbers.glazing.angle_basis import KLEMS_FULL

_FORM = """<?xml version="1.0" encoding="UTF-8"?>
<WindowElement xmlns="http://windows.lbl.gov">
<WindowElementType>System</WindowElementType>
<Optical><Layer><Material><Name>sample</Name></Material>
<DataDefinition><IncidentDataStructure>{structure}</IncidentDataStructure>
{basis}</DataDefinition>
{blocks}</Layer></Optical></WindowElement>
"""
_BLOCK = """<WavelengthData><LayerNumber>System</LayerNumber>
<Wavelength unit="Integral">{wavelength}</Wavelength>
<WavelengthDataBlock><WavelengthDataDirection>{side}</WavelengthDataDirection>
<ColumnAngleBasis>{name}</ColumnAngleBasis><RowAngleBasis>{name}</RowAngleBasis>
<ScatteringDataType>BTDF</ScatteringDataType>
<ScatteringData>{values}</ScatteringData></WavelengthDataBlock></WavelengthData>
"""


def window_xml(sides, basis=KLEMS_FULL, structure="Columns", wavelength="Visible", told=True):
    """The text of a file with matrices (N, N) by side, columns being incident directions."""
    rings, low = [], 0.0
    for high, count in zip(basis.upper_deg, basis.count, strict=True):
        rings.append(
            f"<AngleBasisBlock><Theta>{(low + high) / 2}</Theta><nPhis>{count}</nPhis><ThetaBounds>"
            f"<LowerTheta>{low}</LowerTheta><UpperTheta>{high}</UpperTheta></ThetaBounds>"
            "</AngleBasisBlock>"
        )
        low = high
    defined = (
        f"<AngleBasis><AngleBasisName>{basis.name}</AngleBasisName>{''.join(rings)}</AngleBasis>"
    )
    blocks = [
        _BLOCK.format(
            wavelength=wavelength,
            side=side,
            name=basis.name,
            values="\n".join(",".join(f"{v:.9g}" for v in row) for row in np.asarray(matrix)),
        )
        for side, matrix in sides.items()
    ]
    return _FORM.format(structure=structure, basis=defined if told else "", blocks="".join(blocks))


def diffuser(transmittance, basis=KLEMS_FULL):
    """A Lambertian diffuser's transmission (N, N), sr^-1."""
    return np.full((len(basis), len(basis)), transmittance / np.pi)


def opening(transmittance=1.0, basis=KLEMS_FULL):
    """Transmission (N, N) of a pane that does not scatter."""
    return np.diag(transmittance / basis.projected_sr)
