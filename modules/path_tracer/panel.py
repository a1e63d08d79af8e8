"""The panel of the path-traced picture: the picture is traced while the panel is seen.

The window imports it by the entry point `vrut_lite.panels`; nothing else here imports Qt.
"""

from functools import partial
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QFileDialog,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QWidget,
)

from path_tracer.denoising import can_denoise, without_grain
from path_tracer.messages import PathTracedPicture
from path_tracer.remaining import Remaining, remaining_text
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Demand
from vrut_lite.messages.picture import SetExposure
from vrut_lite.panel_kit import (
    FittedPicture,
    Session,
    display_picture,
    file_title,
    panel_column,
    write_picture,
)
from vrut_lite.quantities import W_M2_SR

_CONSUMER = "window"
_WAITING = "Paths of light are traced while this is seen, without air and clouds."
_WIDTH_PX, _HEIGHT_PX = 560, 400


class Developed(NamedTuple):
    """A picture (h, w, 3) as the screen shows it, its radiance as traced, and how many of its
    samples are there."""

    pixels: NDArray[np.uint8]
    radiance: NDArray[np.float32]
    samples: int
    samples_wanted: int


class TracedPanel(QWidget):
    """Asks for pictures while it is visible; they have the frame's exposure and tone map.

    Denoised or not, it is the same picture: a new one is made from the latest paths.
    """

    title = "Path-traced picture"
    keys = "T"

    def __init__(self, session: Session):
        super().__init__()
        self._session = session
        self.shown: Developed | None = None
        self._latest: PathTracedPicture | None = None
        self._developing = False
        self._remaining = Remaining()
        self.view = FittedPicture("path-traced picture", (_WIDTH_PX, _HEIGHT_PX))
        self.progress = QLabel(_WAITING)
        self.progress.setWordWrap(True)
        self.denoise = QCheckBox("without grain")
        self.denoise.setToolTip(
            "A preview by Intel's Open Image Denoise (Afra 2024); it invents what few paths leave "
            "open"
        )
        self.denoise.setChecked(can_denoise())
        if not can_denoise():
            self.denoise.setEnabled(False)
            self.denoise.setToolTip("It needs the extra `ref`: pip install 'vrut-lite[ref]'")
        self.keep = QPushButton("Save\N{HORIZONTAL ELLIPSIS}")
        self.keep.setToolTip(f"PNG or JPEG as shown, EXR of linear radiance in {W_M2_SR}")
        self.keep.setEnabled(False)
        row = QHBoxLayout()
        row.addWidget(self.progress, 1)
        row.addWidget(self.denoise)
        row.addWidget(self.keep)
        column = panel_column(self)
        column.addWidget(self.view, 1)
        column.addLayout(row)
        self.denoise.clicked.connect(lambda _: self._develop())
        self.keep.clicked.connect(self._ask_to_save)
        session.listen(PathTracedPicture, self._hear)

    def showEvent(self, event: QShowEvent) -> None:
        """Ask for the picture; the last one may be of another hour."""
        self._latest = self.shown = None
        self.view.show_pixels(None)
        self.keep.setEnabled(False)
        self.progress.setText(_WAITING)
        self._demand(None)

    def hideEvent(self, event: QHideEvent) -> None:
        """Take the demand back."""
        if not self._session.has_ended:
            self._demand(0)

    def save(self, path: str) -> None:
        """Write the shown picture; a fault is shown in a sentence."""
        if self.shown is None:
            return
        said: dict[str, str | float] = {
            "engine": "path tracer",
            "samplesPerPixel": self.shown.samples,
        }
        try:
            write_picture(path, self.shown.radiance, self.shown.pixels, said)
        except UserError as error:
            self._session.problem.emit(str(error))
        else:
            self.progress.setText(f"Saved {path}")

    def _ask_to_save(self) -> None:
        name = f"{file_title(self._session)} path traced.png"
        kinds = "Pictures (*.png *.jpg *.exr)"
        path, _ = QFileDialog.getSaveFileName(self, "Save the path-traced picture", name, kinds)
        if path:
            self.save(path)

    def _demand(self, size: int | None) -> None:
        self._session.send(
            Demand(consumer=_CONSUMER, message=PathTracedPicture.__name__, size=size)
        )

    def _hear(self, message: PathTracedPicture) -> None:
        self._remaining.came(perf_counter(), message.samples)
        self._latest = message
        if self.isVisible():
            self._develop()

    def _develop(self) -> None:
        """Off Qt's thread: a tone map takes a tenth of a second, the denoiser one; the latest
        picture follows when that is done."""
        if self._latest is None or self._developing:
            return
        self._developing = True
        frame = self._session.shown
        ev100 = None if frame is None else frame.picture.ev100
        wish = self._session.last(SetExposure) or SetExposure()
        question = partial(_developed, self._latest, ev100, wish, self.denoise.isChecked())
        asked = (self._latest, self.denoise.isChecked())
        self._session.look_up(
            lambda _: question(), partial(self._show, asked), lambda line: self._fail(line)
        )

    def _fail(self, line: str) -> None:
        self._developing = False
        self.progress.setText(line)

    def _show(self, asked: tuple[PathTracedPicture, bool], developed: Developed) -> None:
        self._developing = False
        if self._latest is None:
            # It was hidden and shown meanwhile.
            return
        self.shown = developed
        self.view.show_pixels(developed.pixels)
        self.keep.setEnabled(True)
        left = remaining_text(self._remaining.seconds(developed.samples_wanted))
        done = f"{developed.samples:,} of {developed.samples_wanted:,} paths a pixel"
        self.progress.setText(f"{done}, {left}" if left else done)
        latest, denoises = asked
        is_old = latest is not self._latest or denoises != self.denoise.isChecked()
        if is_old and self.isVisible():
            self._develop()


def _developed(
    message: PathTracedPicture, ev100: float | None, wish: SetExposure, denoises: bool
) -> Developed:
    traced = message.radiance.values
    shown = without_grain(traced) if denoises else traced
    pixels = display_picture(shown, ev100, wish, pixel_rad=message.pixel_rad)
    return Developed(pixels.astype(np.uint8), traced, message.samples, message.samples_wanted)
