"""The row of one setting: name, editor, reset."""

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QGridLayout,
    QLabel,
    QLineEdit,
    QToolButton,
    QWidget,
)

from vrut_lite.app.file_field import FileField
from vrut_lite.app.icons import put_sign
from vrut_lite.app.panels.number_field import FieldScale, NumberField
from vrut_lite.app.setting_words import (
    choice_label,
    label_of,
    left_open_label,
    tooltip_of,
    value_text,
)
from vrut_lite.app.widgets import Chooser
from vrut_lite.kernel.settings import SettingSpec


class SettingRow(QObject):
    """The widgets of a row, in a grid of four columns: name, editor, reset.

    `edited` emits a value that the user set, which may be None; `show_value` emits nothing.
    """

    edited = Signal(object)

    def __init__(self, spec: SettingSpec, value: Any, parent: QWidget):
        super().__init__(parent)
        self.spec = spec
        self.name = self._name(parent)
        # Effective value of the unset setting, where known.
        self._stands_for: Any = None
        self.editor, self._show = self._editor()
        self.reset = QToolButton()
        put_sign(self.reset, "reset")
        self.reset.setProperty("flat", True)
        self.reset.setAccessibleName(f"reset {label_of(spec)}")
        self.reset.setToolTip(f"Back to {value_text(spec, spec.default)}")
        self.reset.clicked.connect(lambda: self.edited.emit(spec.default))
        for part in (self.name, self.editor):
            part.setToolTip(tooltip_of(spec))
        self.editor.setAccessibleName(label_of(spec))
        self.show_value(value)

    def put_in(self, grid: QGridLayout, row: int) -> None:
        """Place the widgets in a row of a grid."""
        for column, part in enumerate((self.name, self.editor, self.reset)):
            grid.addWidget(part, row, column)

    def show_value(self, value: Any, stands_for: Any = None) -> None:
        """Show the setting's present value; while it is unset, what it stands for."""
        self._stands_for = stands_for
        self.reset.setEnabled(value != self.spec.default)
        if isinstance(self.name, QCheckBox):
            self.name.blockSignals(True)
            self.name.setChecked(value is not None)
            self.name.blockSignals(False)
        if isinstance(self.editor, QComboBox) and self.spec.may_be_none:
            known = "" if stands_for is None else f" ({choice_label(self.spec, stands_for)})"
            self.editor.setItemText(0, left_open_label(self.spec) + known)
        if value is not None or self.spec.choices:
            self._show(value)
        elif stands_for is not None:
            self._show(stands_for)
        elif isinstance(self.editor, NumberField):
            self.editor.show_words(left_open_label(self.spec))

    def _name(self, parent: QWidget) -> QLabel | QCheckBox:
        """A label; for a number that may be none, a check box that is off for none."""
        if not self.spec.may_be_none or self.spec.choices:
            label = QLabel(label_of(self.spec), parent)
            label.setWordWrap(True)
            return label
        box = QCheckBox(label_of(self.spec), parent)
        box.toggled.connect(lambda on: self.edited.emit(self._start() if on else None))
        return box

    def _start(self) -> Any:
        """The first value of a setting that was none: what it stood for."""
        spec = self.spec
        if self._stands_for is not None:
            return spec.type(self._stands_for)
        if spec.type not in (int, float):
            return spec.type()
        if spec.at_least is None or spec.at_most is None:
            return spec.type(spec.at_least or 0)
        return spec.type(FieldScale(spec.at_least, spec.at_most).value_at(0.5))

    def _editor(self) -> tuple[QWidget, Callable[[Any], None]]:
        if self.spec.choices:
            return self._choice()
        if self.spec.type is bool:
            return self._switch()
        if self.spec.type in (int, float):
            return self._number()
        return self._text()

    def _choice(self) -> tuple[QWidget, Callable[[Any], None]]:
        box = Chooser()
        if self.spec.may_be_none:
            box.addItem(left_open_label(self.spec), None)
        for choice in self.spec.choices:
            box.addItem(choice_label(self.spec, choice), choice)
        box.activated.connect(lambda index: self.edited.emit(box.itemData(index)))
        return box, lambda value: box.setCurrentIndex(box.findData(value))

    def _switch(self) -> tuple[QWidget, Callable[[Any], None]]:
        box = QCheckBox()
        box.clicked.connect(lambda on: self.edited.emit(bool(on)))
        return box, lambda value: box.setChecked(bool(value))

    def _number(self) -> tuple[QWidget, Callable[[Any], None]]:
        spec = self.spec
        field = NumberField(spec.at_least, spec.at_most, spec.unit, whole=spec.type is int)
        field.edited.connect(lambda value: self.edited.emit(spec.type(value)))
        return field, lambda value: field.show_value(float(value))

    def _text(self) -> tuple[QWidget, Callable[[Any], None]]:
        kinds = self.spec.file_kinds
        line: FileField | QLineEdit = FileField(kinds) if kinds else QLineEdit()
        shown = [""]

        def show(value: Any) -> None:
            shown[0] = str(value)
            line.setText(shown[0])

        def finished() -> None:
            # Qt emits it at every loss of focus, also without a change.
            if line.text() != shown[0]:
                shown[0] = line.text()
                self.edited.emit(line.text())

        line.editingFinished.connect(finished)
        return line, show
