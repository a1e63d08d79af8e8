"""Rows of a name and what it is the name of."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFormLayout, QWidget


def aligned_form(parent: QWidget | None = None) -> QFormLayout:
    """A form whose names stand in the middle of their rows; fields take the width there is."""
    form = QFormLayout(parent)
    form.setLabelAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
    form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
    form.setHorizontalSpacing(12)
    form.setVerticalSpacing(6)
    return form
