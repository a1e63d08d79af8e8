"""A number with a slider and a spin box."""

import math

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QSlider, QVBoxLayout, QWidget

from vrut_lite.quantities import suffix_of

_NOTCHES = 1000
# From this ratio of the range's ends the slider is logarithmic.
_LOGARITHMIC_FROM = 100.0
_TYPED_WIDTH_PX = 92
_UNBOUNDED = 1e9


class NumberField(QWidget):
    """`edited` emits a value that the user set; `show_value` emits nothing."""

    edited = Signal(float)

    def __init__(
        self,
        low: float | None,
        high: float | None,
        unit: str = "",
        whole: bool = False,
        decimals: int | None = None,
    ):
        super().__init__()
        self._scale = None if low is None or high is None else FieldScale(low, high)
        self.spin = NumberSpin()
        self.spin.setRange(
            -_UNBOUNDED if low is None else low, _UNBOUNDED if high is None else high
        )
        self.spin.setDecimals(
            0 if whole else _decimals(low, high) if decimals is None else decimals
        )
        self.spin.setSingleStep(1.0 if whole else 10.0 ** -max(self.spin.decimals() - 1, 0))
        self.spin.setSuffix(suffix_of(unit))
        self.slider = _Slider(Qt.Orientation.Horizontal)
        self.slider.setRange(0, _NOTCHES)
        self.slider.setPageStep(_NOTCHES // 20)
        self.slider.setSingleStep(_NOTCHES // 100)
        self.slider.setVisible(self._scale is not None)
        row, lines = QHBoxLayout(), QVBoxLayout(self)
        self._row, self._lines = row, lines
        lines.setContentsMargins(0, 0, 0, 0)
        lines.setSpacing(2)
        lines.addLayout(row)
        row.setSpacing(8)
        row.addWidget(self.slider, 1)
        # On the right also where there is no slider.
        row.addWidget(self.spin, alignment=Qt.AlignmentFlag.AlignRight)
        self.setFocusProxy(self.spin)
        self.slider.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.slider.valueChanged.connect(self._slid)
        self.spin.valueChanged.connect(self._typed)

    @property
    def value(self) -> float:
        """The shown value."""
        return self.spin.value()

    def show_value(self, value: float) -> None:
        """Show a value, unless the slider is being dragged."""
        if self.slider.isSliderDown():
            return
        self._show(value, slider=True)

    def show_words(self, words: str) -> None:
        """Show words where there is no value."""
        self._show(self.spin.minimum(), slider=True)
        # Qt shows them in place of the lowest value.
        self.spin.setSpecialValueText(words)

    def _show(self, value: float, slider: bool) -> None:
        self.spin.setSpecialValueText("")
        for part in (self.spin, self.slider):
            part.blockSignals(True)
        self.spin.setValue(value)
        if slider and self._scale is not None:
            self.slider.setValue(round(self._scale.share_of(value) * _NOTCHES))
        for part in (self.spin, self.slider):
            part.blockSignals(False)

    def _slid(self, notch: int) -> None:
        assert self._scale is not None
        self._show(self._scale.value_at(notch / _NOTCHES), slider=False)
        self.edited.emit(self.spin.value())

    def _typed(self, value: float) -> None:
        self._show(value, slider=True)
        self.edited.emit(value)


class _Slider(QSlider):
    def wheelEvent(self, event: QWheelEvent) -> None:
        """Ignore the wheel without focus: it scrolls the panel."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


class NumberSpin(QDoubleSpinBox):
    """A typed number: thousands in groups, sent when it is whole."""

    def __init__(self) -> None:
        super().__init__()
        self.setGroupSeparatorShown(True)
        self.setKeyboardTracking(False)
        self.setFixedWidth(_TYPED_WIDTH_PX)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Ignore the wheel without focus: it scrolls the panel."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


class FieldScale:
    """Maps a range of values to 0..1, linearly or logarithmically."""

    def __init__(self, low: float, high: float):
        self._low, self._high = low, high
        self.logarithmic = low > 0.0 and high / low >= _LOGARITHMIC_FROM

    def share_of(self, value: float) -> float:
        """0 at the low end, 1 at the high one."""
        value = min(max(value, self._low), self._high)
        if self.logarithmic:
            return math.log(value / self._low) / math.log(self._high / self._low)
        span = self._high - self._low
        return (value - self._low) / span if span else 0.0

    def value_at(self, share: float) -> float:
        """The value there."""
        if self.logarithmic:
            return self._low * (self._high / self._low) ** share
        return self._low + share * (self._high - self._low)


def _decimals(low: float | None, high: float | None) -> int:
    """Decimals that show a hundredth of the range, or of its low end if it is logarithmic."""
    if low is None or high is None:
        return 3
    finest = low if FieldScale(low, high).logarithmic else high - low
    return min(max(2 - math.floor(math.log10(max(finest, 1e-6))), 0), 6)
