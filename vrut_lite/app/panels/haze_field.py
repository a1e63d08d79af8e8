"""The control of the haze, with its value on other scales."""

import numpy as np

from vrut_lite.app.panels.number_field import NumberField
from vrut_lite.atmosphere.equal_haze import DEPTHS, MOST_DEPTH, TURBIDITIES
from vrut_lite.messages.haze import DEFAULT_HAZE, MOST_OPTICAL_DEPTH, SetHaze


class HazeField(NumberField):
    """A number field of the optical depth at 550 nm; its tooltip gives the turbidities."""

    def __init__(self, explanation: str):
        super().__init__(0.0, MOST_OPTICAL_DEPTH, decimals=3)
        self._explanation = explanation
        self.edited.connect(self._explain)
        self.show_value(DEFAULT_HAZE.optical_depth_550)

    def show_value(self, value: float) -> None:
        """Show an optical depth."""
        super().show_value(value)
        self._explain(value)

    def _explain(self, optical_depth_550: float) -> None:
        haze = SetHaze(optical_depth_550=optical_depth_550)
        self.setToolTip(f"{self._explanation}\n{depth_text(haze)}")


def depth_text(haze: SetHaze) -> str:
    """An optical depth, as turbidity on Preetham's scale and on that of Hosek and Wilkie."""
    depth = haze.optical_depth_550
    said = (
        f"Aerosol optical depth {depth:.3f} at 550 nm: turbidity {haze.turbidity:.2f} on "
        "Preetham's scale (1999, A.1)."
    )
    if depth > MOST_DEPTH:
        return f"{said} Hosek and Wilkie's sky cannot follow beyond {MOST_DEPTH:g}."
    equal = float(np.interp(depth, DEPTHS, TURBIDITIES))
    return (
        f"{said} Hosek and Wilkie's sky has the shape of continental haze of this depth at "
        f"turbidity {equal:.1f}, and is then 1.1 to 2 times too bright as published."
    )
