"""The control of the haze: from clear to hazy, by optical depth, by turbidity."""

import numpy as np
from PySide6.QtWidgets import QHBoxLayout

from vrut_lite.app.panels.number_field import NumberField, NumberSpin
from vrut_lite.app.widgets import faint_label
from vrut_lite.atmosphere.aerosol import LEAST_TURBIDITY, MOST_TURBIDITY, optical_depth_of_turbidity
from vrut_lite.atmosphere.equal_haze import DEPTHS, MOST_DEPTH, TURBIDITIES
from vrut_lite.messages.haze import DEFAULT_HAZE, MOST_OPTICAL_DEPTH, SetHaze
from vrut_lite.quantities import figure


class HazeField(NumberField):
    """A slider from "clear" to "hazy"; below it the optical depth at 550 nm, which is the value,
    and the same on Preetham's scale of turbidity."""

    def __init__(self, explanation: str):
        super().__init__(0.0, MOST_OPTICAL_DEPTH, decimals=3)
        self._explanation = explanation
        self.spin.setPrefix("AOD ")
        self.spin.setAccessibleName("aerosol optical depth at 550 nm")
        self.turbidity = NumberSpin()
        self.turbidity.setPrefix("T ")
        self.turbidity.setDecimals(2)
        self.turbidity.setRange(LEAST_TURBIDITY, MOST_TURBIDITY)
        self.turbidity.setAccessibleName("turbidity on Preetham's scale")
        self._lay_out()
        self.turbidity.valueChanged.connect(
            lambda turbidity: self.spin.setValue(float(optical_depth_of_turbidity(turbidity)))
        )
        self.edited.connect(self._explain)
        self.show_value(DEFAULT_HAZE.optical_depth_550)

    def show_value(self, value: float) -> None:
        """Show an optical depth."""
        super().show_value(value)
        self._explain(value)

    def _lay_out(self) -> None:
        """Words at the slider's ends, and a line of numbers below."""
        upper, lower = self._row, QHBoxLayout()
        upper.removeWidget(self.spin)
        upper.insertWidget(0, faint_label("clear"))
        upper.addWidget(faint_label("hazy"))
        lower.setSpacing(upper.spacing())
        lower.addStretch(1)
        for spin in (self.spin, self.turbidity):
            lower.addWidget(spin)
        self._lines.addLayout(lower)

    def _explain(self, optical_depth_550: float) -> None:
        haze = SetHaze(optical_depth_550=optical_depth_550)
        self.turbidity.blockSignals(True)
        self.turbidity.setValue(haze.turbidity)
        self.turbidity.blockSignals(False)
        self.setToolTip(f"{self._explanation}.\n{depth_text(haze)}")


def depth_text(haze: SetHaze) -> str:
    """An optical depth, as turbidity on Preetham's scale and on that of Hosek and Wilkie."""
    depth = haze.optical_depth_550
    said = (
        f"AOD {depth:.3f}: aerosol optical depth at 550 nm, a number without unit. T "
        f"{haze.turbidity:.2f}: turbidity on Preetham's scale (1999, A.1)."
    )
    if depth > MOST_DEPTH:
        return f"{said} Hosek and Wilkie's sky cannot follow beyond AOD {figure(MOST_DEPTH)}."
    equal = float(np.interp(depth, DEPTHS, TURBIDITIES))
    return (
        f"{said} Hosek and Wilkie's sky has the shape of continental haze of this depth at "
        f"turbidity {equal:.1f}, and is then 1.1 to 2 times too bright as published."
    )
