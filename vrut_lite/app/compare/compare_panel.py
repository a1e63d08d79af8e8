"""The panel of two skies side by side, at equal haze."""

from typing import TYPE_CHECKING

from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QGridLayout, QLabel, QWidget

from vrut_lite.app import theme
from vrut_lite.app.compare.sky_comparison import (
    ANGLES_DEG,
    HAZE,
    SLOT,
    ComparedSkies,
    SkyComparison,
    Spectra,
    comparable,
)
from vrut_lite.app.compare.sky_disc import SkyDisc
from vrut_lite.app.compare.sky_plots import SkyPlots
from vrut_lite.app.engine.module_catalogue import ModuleCatalogue, ModuleInfo
from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.haze_field import HazeField, depth_text
from vrut_lite.app.panels.number_field import NumberField
from vrut_lite.app.panels.sky_panel import add_module
from vrut_lite.app.setting_words import label_of, tooltip_of
from vrut_lite.app.view.viewport import Viewport
from vrut_lite.app.widgets import Chooser, aligned_form, faint_label, panel_column
from vrut_lite.quantities import DEGREE

if TYPE_CHECKING:
    from vrut_lite.app.compare.sky_plots import SkyPlots

# The line styles of `sky_plots`.
_MARKS = ((theme.ACCENT, "\N{EM DASH}"), ("#8fb4e8", "\N{EN DASH} \N{EN DASH}"))


class ComparePanel(QWidget):
    """Fisheyes of both at one exposure, and curves; compares only while it is visible."""

    def __init__(self, session: Session, viewport: Viewport):
        super().__init__()
        self.comparison = SkyComparison(session, self)
        self._modules: list[ModuleInfo] = []
        self.choosers = (Chooser(), Chooser())
        self.discs = (SkyDisc("left sky"), SkyDisc("right sky"))
        self.hazes = (faint_label(wraps=True), faint_label(wraps=True))
        self.fields: dict[str, NumberField] = {}
        self._form = aligned_form()
        self.aerosol, self.ratio, self.status = (faint_label(wraps=True) for _ in range(3))
        self.plots: SkyPlots | None = None
        self._lay_out()
        self._connect(session, viewport)

    def _lay_out(self) -> None:
        grid = QGridLayout()
        for side, (chooser, disc) in enumerate(zip(self.choosers, self.discs, strict=True)):
            colour, line = _MARKS[side]
            mark = QLabel(f'<span style="color: {colour}">{line}</span>')
            chooser.setAccessibleName(disc.accessibleName())
            grid.addWidget(mark, 0, 2 * side)
            grid.addWidget(chooser, 0, 2 * side + 1)
            grid.addWidget(disc, 1, 2 * side, 1, 2)
            grid.addWidget(self.hazes[side], 2, 2 * side, 1, 2)
            grid.setColumnStretch(2 * side + 1, 1)
        self._column = panel_column(self)
        self._column.addLayout(grid)
        self._column.addLayout(self._form)
        for label in (self.aerosol, self.ratio):
            self._column.addWidget(label)
        self._column.addStretch(1)
        self._column.addWidget(self.status)

    def _connect(self, session: Session, viewport: Viewport) -> None:
        for chooser in self.choosers:
            chooser.activated.connect(lambda _: self._choose())
        for disc in self.discs:
            disc.pointed.connect(self.comparison.look_along)
        viewport.sky_pointed.connect(self.comparison.look_along)
        self.comparison.compared.connect(self._show)
        self.comparison.spectra_seen.connect(self._show_spectra)
        self.comparison.refused.connect(self.status.setText)
        self.comparison.shared_changed.connect(self._show_shared)
        session.ready.connect(self._fill)

    def _fill(self, catalogue: ModuleCatalogue) -> None:
        shown = catalogue.holders.get(SLOT)
        # The window's own sky first.
        self._modules = sorted(comparable(catalogue), key=lambda module: module.name != shown)
        for side, chooser in enumerate(self.choosers):
            for module in self._modules:
                add_module(chooser, module)
            chooser.setCurrentIndex(min(side, chooser.count() - 1))
        if self._modules:
            self._choose()
        else:
            self.status.setText("There are no two skies to compare.")

    def _choose(self) -> None:
        """Make a row for the haze, and one for each setting that both skies have."""
        left, right = (self._modules[chooser.currentIndex()] for chooser in self.choosers)
        for chooser, module in zip(self.choosers, (left, right), strict=True):
            chooser.setToolTip(module.name)
        while self._form.rowCount():
            self._form.removeRow(0)
        self.fields.clear()
        specs = self.comparison.choose(left, right)
        haze = HazeField("Haze of both skies")
        haze.show_value(self.comparison.haze.optical_depth_550)
        self._add_row(HAZE, "Haze", haze)
        for spec in specs:
            field = NumberField(spec.at_least, spec.at_most, spec.unit)
            field.show_value(self.comparison.shared[spec.name])
            field.setToolTip(f"{tooltip_of(spec)}\nSets both skies")
            self._add_row(spec.name, label_of(spec), field)

    def _add_row(self, name: str, label: str, field: NumberField) -> None:
        field.setAccessibleName(f"{label} of both")
        field.edited.connect(lambda value: self.comparison.share(name, value))
        self._form.addRow(label, field)
        self.fields[name] = field

    def _show_shared(self, name: str, value: float) -> None:
        # The rows come with the modules.
        if name in self.fields:
            self.fields[name].show_value(value)

    def showEvent(self, event: QShowEvent) -> None:
        """Start the comparison."""
        if self.plots is None and self._modules:
            self.status.setText("Computing both skies\N{HORIZONTAL ELLIPSIS}")
        self.comparison.set_active(True)

    def hideEvent(self, event: QHideEvent) -> None:
        """Stop the comparison."""
        self.comparison.set_active(False)

    def _show(self, compared: ComparedSkies) -> None:
        two = compared.two
        for disc, pixels in zip(self.discs, compared.discs, strict=True):
            disc.show_sky(pixels, two.sun.direction, two.wish.place.north_offset_rad)
        self.aerosol.setText(depth_text(two.wish.haze))
        for label in self.hazes:
            label.setText(f"AOD {two.wish.haze.optical_depth_550:.3f} at 550 nm")
        low, middle, high = compared.ratios
        self.ratio.setText(
            f"Luminance, right over left: {middle:.2f} in the middle, {low:.2f} to {high:.2f} "
            f"for nine tenths of the sky from 5{DEGREE} up; both at EV100 "
            f"{compared.ev100:.1f}."
        )
        self.status.clear()
        self._plots().show_meridian(ANGLES_DEG, compared.meridian_cd_m2)

    def _show_spectra(self, spectra: Spectra) -> None:
        for disc in self.discs:
            disc.show_direction(spectra.direction)
        without = [
            chooser.currentText()
            for chooser, seen in zip(self.choosers, spectra.seen, strict=True)
            if seen is None or not seen.wavelength_nm
        ]
        self.status.setText(f"Without a spectrum here: {', '.join(without)}" if without else "")
        self._plots().show_spectra(spectra.seen)

    def _plots(self) -> "SkyPlots":
        """The plots, made for the first data."""
        if self.plots is None:
            self.plots = SkyPlots()
            self._column.insertWidget(self._column.count() - 2, self.plots)
        return self.plots
