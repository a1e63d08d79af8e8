"""The window's theme: neutral greys, which do not bias the eye's judgement of colours."""

from PySide6.QtCore import QLocale
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QApplication

BACKGROUND, PANEL, RAISED, LINE = "#1b1b1d", "#232326", "#2e2e32", "#3b3b40"
TEXT, FAINT, ACCENT, ALARM = "#d8d8d6", "#8d8d90", "#e2b36a", "#e58a78"

_STYLE = f"""
QWidget {{ font-size: 12px; }}
QToolTip {{ background: {RAISED}; color: {TEXT}; border: 1px solid {LINE}; padding: 4px; }}
QMainWindow::separator {{ background: {BACKGROUND}; width: 4px; height: 4px; }}
QDockWidget {{ color: {FAINT}; }}
QDockWidget::title {{ background: {PANEL}; padding: 5px 8px; }}
QTabBar {{ qproperty-drawBase: 0; qproperty-elideMode: ElideNone; qproperty-usesScrollButtons: 1; }}
QTabBar::tab {{ background: {BACKGROUND}; color: {FAINT}; padding: 6px 11px; border: none; }}
QTabBar::tab:selected {{ background: {PANEL}; color: {TEXT}; border-top: 2px solid {ACCENT}; }}
QTabBar QToolButton {{ padding: 0; border: none; }}
QTabBar::tab:focus {{ color: {ACCENT}; }}
QScrollArea, QScrollArea > QWidget > QWidget {{ background: {PANEL}; border: none; }}
QLineEdit, QComboBox, QAbstractSpinBox {{
    background: {BACKGROUND}; border: 1px solid {LINE}; border-radius: 3px; padding: 2px 5px;
    min-height: 18px; selection-background-color: {ACCENT}; selection-color: {BACKGROUND};
}}
QAbstractSpinBox QLineEdit {{ border: none; padding: 0 2px; min-height: 0; }}
QLineEdit:focus, QComboBox:focus, QAbstractSpinBox:focus {{ border-color: {ACCENT}; }}
QLineEdit:disabled, QComboBox:disabled, QAbstractSpinBox:disabled {{ color: #5c5c60; }}
QSpinBox::up-button, QSpinBox::down-button, QDoubleSpinBox::up-button,
QDoubleSpinBox::down-button {{
    width: 0; border: none;
}}
QPushButton, QToolButton {{
    background: {RAISED}; border: 1px solid {LINE}; border-radius: 3px; padding: 3px 9px;
}}
QPushButton:hover, QToolButton:hover {{ background: #3a3a3f; }}
QPushButton:focus, QToolButton:focus {{ border-color: {ACCENT}; }}
QPushButton:checked, QToolButton:checked {{ background: {ACCENT}; color: {BACKGROUND}; }}
QToolButton[flat="true"] {{ background: transparent; border: none; padding: 0; color: {FAINT}; }}
QToolButton[flat="true"]:hover, QToolButton[flat="true"]:focus {{ color: {ACCENT}; }}
QToolButton[flat="true"]:disabled {{ color: transparent; }}
QSlider::groove:horizontal {{ height: 3px; background: {LINE}; border-radius: 1px; }}
QSlider::sub-page:horizontal {{ background: #77777c; border-radius: 1px; }}
QSlider::sub-page:horizontal:disabled {{ background: {LINE}; }}
QSlider::handle:horizontal {{
    width: 10px; height: 14px; margin: -6px 0; border-radius: 3px; background: #b9b9bb;
}}
QSlider::handle:horizontal:hover, QSlider::handle:horizontal:focus {{ background: {ACCENT}; }}
QSlider::handle:horizontal:disabled {{ background: #4a4a4e; }}
QCheckBox::indicator {{
    width: 12px; height: 12px; border: 1px solid #5c5c62; border-radius: 3px;
    background: {BACKGROUND};
}}
QCheckBox::indicator:hover, QCheckBox::indicator:focus {{ border-color: {ACCENT}; }}
QCheckBox::indicator:checked {{ background: {ACCENT}; border-color: {ACCENT}; }}
QTreeView, QPlainTextEdit {{ background: {BACKGROUND}; border: 1px solid {LINE}; }}
QTreeView:focus, QPlainTextEdit:focus {{ border-color: {ACCENT}; }}
QTreeView::item {{ padding: 3px 2px; border: none; }}
QTreeView::item:hover {{ background: {RAISED}; }}
QTreeView::item:selected {{ background: {LINE}; color: {TEXT}; }}
QTreeView::indicator {{
    width: 11px; height: 11px; border: 1px solid #5c5c62; border-radius: 3px;
    background: {BACKGROUND};
}}
QTreeView::indicator:checked {{ background: {ACCENT}; border-color: {ACCENT}; }}
QHeaderView {{ background: {PANEL}; border: none; }}
QHeaderView::section {{
    background: {PANEL}; color: {FAINT}; border: none; padding: 4px 4px;
}}
QLabel[role="heading"] {{ color: {TEXT}; font-weight: 600; }}
QLabel[role="faint"] {{ color: {FAINT}; }}
QStatusBar {{ background: {PANEL}; color: {FAINT}; }}
QStatusBar::item {{ border: none; }}
QScrollBar:vertical {{ background: {PANEL}; width: 9px; margin: 0; }}
QScrollBar:horizontal {{ background: {PANEL}; height: 9px; margin: 0; }}
QScrollBar::handle {{ background: {LINE}; border-radius: 3px; margin: 1px; min-height: 24px; }}
QScrollBar::handle:hover {{ background: #55555a; }}
QScrollBar::add-line, QScrollBar::sub-line {{ width: 0; height: 0; }}
QScrollBar::add-page, QScrollBar::sub-page {{ background: none; }}
QMenuBar, QMenu {{ background: {PANEL}; }}
QMenu::item:selected, QMenuBar::item:selected {{ background: {LINE}; color: {TEXT}; }}
QMenu::item:disabled {{ color: #5c5c60; }}
QMenu::separator {{ background: {LINE}; height: 1px; margin: 4px 8px; }}
QComboBox QAbstractItemView, QListView {{
    background: {BACKGROUND}; border: 1px solid {LINE}; outline: none;
    selection-background-color: {ACCENT}; selection-color: {BACKGROUND};
}}
"""


def apply_theme(app: QApplication) -> None:
    """Paint every window of the application dark; numbers are written in English, as words are."""
    app.setStyle("Fusion")
    QLocale.setDefault(QLocale(QLocale.Language.English, QLocale.Country.UnitedKingdom))
    palette = QPalette()
    role = QPalette.ColorRole
    for part, colour in {
        role.Window: PANEL,
        role.WindowText: TEXT,
        role.Base: BACKGROUND,
        role.AlternateBase: RAISED,
        role.Text: TEXT,
        role.PlaceholderText: FAINT,
        role.Button: RAISED,
        role.ButtonText: TEXT,
        role.ToolTipBase: RAISED,
        role.ToolTipText: TEXT,
        role.Highlight: ACCENT,
        role.HighlightedText: BACKGROUND,
    }.items():
        palette.setColor(part, QColor(colour))
    for part in (role.WindowText, role.Text, role.ButtonText):
        palette.setColor(QPalette.ColorGroup.Disabled, part, QColor("#5c5c60"))
    app.setPalette(palette)
    app.setStyleSheet(_STYLE)
