"""Forms: rows of a label and a field."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFormLayout, QWidget


def aligned_form(parent: QWidget | None = None) -> QFormLayout:
    """A form with vertically centred labels; fields take the free width."""
    form = QFormLayout(parent)
    form.setLabelAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
    form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
    form.setHorizontalSpacing(12)
    form.setVerticalSpacing(6)
    return form
