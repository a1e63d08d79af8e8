"""Plots of two skies: luminance along the sun's meridian, spectra of one direction.

pyqtgraph takes 0.3 s to import, which a start need not wait for. Its import visits all of Qt's
classes, which PySide creates on first use: on another thread than Qt's it sometimes crashed.
"""

import math
from typing import Any

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QVBoxLayout, QWidget

from vrut_lite.app import theme
from vrut_lite.messages.sky import SpectrumSeen
from vrut_lite.quantities import CD_M2, DEGREE, figure

# Told apart by colour and by line.
LINES = ((theme.ACCENT, Qt.PenStyle.SolidLine), ("#8fb4e8", Qt.PenStyle.DashLine))
_HEIGHT_PX = 170
_LEAST_CD_M2 = 1e-6
# Height (px) of a label on the luminance axis; decades below which powers of ten are too few.
_LABEL_PX, _FEW_DECADES = 28.0, 2.5


class SkyPlots(QWidget):
    """Both plots, one below the other."""

    def __init__(self) -> None:
        super().__init__()
        self.meridian = _plot(
            f"angle from the zenith towards the sun, {DEGREE}",
            CD_M2,
            logarithmic=True,
        )
        self.meridian.setLogMode(y=True)
        self.meridian.setXRange(-90.0, 90.0, padding=0.02)
        self.meridian.setAccessibleName("luminance along the sun's meridian")
        self.spectrum = _plot(
            "wavelength, nm",
            "W/(m\N{SUPERSCRIPT TWO} sr nm)",
        )
        self.spectrum.setAccessibleName("spectrum of the direction that is pointed at")
        self.curves = [self.meridian.plot(pen=_pen(*line)) for line in LINES]
        self.spectra = [
            self.spectrum.plot(
                pen=_pen(*line), symbol="o", symbolSize=4, symbolBrush=line[0], symbolPen=None
            )
            for line in LINES
        ]
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.meridian)
        column.addWidget(self.spectrum)
        # Axes without a curve have figures that mean nothing.
        self.spectrum.hide()

    def show_meridian(self, angle_deg: NDArray[np.float64], cd_m2: NDArray[np.float64]) -> None:
        """Luminances (2, n) at angles (n,)."""
        for curve, values in zip(self.curves, cd_m2, strict=True):
            curve.setData(angle_deg, np.maximum(values, _LEAST_CD_M2))

    def show_spectra(self, spectra: list[SpectrumSeen | None]) -> None:
        """Show a curve for each; none for a sky without a spectrum."""
        self.spectrum.show()
        for curve, seen in zip(self.spectra, spectra, strict=True):
            if seen is None:
                curve.setData([], [])
            else:
                curve.setData(seen.wavelength_nm, seen.radiance)


class LogAxis(pg.AxisItem):
    """An axis of decimal logarithms that is labelled at powers of ten, or at 2 and 5 between.

    pyqtgraph's own labels each line of its grid, one over the other.
    """

    def tickValues(self, low: float, high: float, size: float) -> list[tuple[float, list[float]]]:
        """Levels of (spacing, places); only the first is labelled."""
        decades = list(range(math.ceil(low), math.floor(high) + 1))
        step = max(1, math.ceil((high - low) / max(size / _LABEL_PX, 1.0)))
        labelled = [float(n) for n in decades if n % step == 0]
        if high - low < _FEW_DECADES:
            parts = [math.log10(part) for part in (1, 2, 5)]
            every = [n + part for n in range(math.floor(low), math.ceil(high)) for part in parts]
            labelled = [place for place in every if low <= place <= high]
        return [(1.0, labelled), (1.0, [float(n) for n in decades if float(n) not in labelled])]

    def logTickStrings(self, values: list[float], scale: float, spacing: float) -> list[str]:
        """Luminances as people write them: 0.002, 5, 20,000."""
        return [figure(float(f"{10.0**value:.1g}")) for value in values]


def _plot(bottom: str, left: str, logarithmic: bool = False) -> Any:
    axes = {"left": LogAxis("left")} if logarithmic else {}
    plot = pg.PlotWidget(background=theme.PANEL, axisItems=axes)
    plot.setFixedHeight(_HEIGHT_PX)
    plot.setMenuEnabled(False)
    plot.hideButtons()
    plot.showGrid(x=True, y=True, alpha=0.15)
    for side, text in (("bottom", bottom), ("left", left)):
        axis = plot.getAxis(side)
        axis.setPen(theme.LINE)
        axis.setTextPen(theme.FAINT)
        axis.enableAutoSIPrefix(False)
        axis.setLabel(text, color=theme.FAINT)
    return plot


def _pen(colour: str, style: Qt.PenStyle) -> Any:
    return pg.mkPen(colour, width=1.6, style=style)
