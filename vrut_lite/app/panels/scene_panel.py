"""The scene's file: its size, axes, units, cameras, variants, and what of it is not shown."""

from time import perf_counter

import msgspec
from PySide6.QtWidgets import QPushButton, QVBoxLayout

from vrut_lite.app.engine.session import Session
from vrut_lite.app.panels.module_panel import ModulePanel
from vrut_lite.app.panels.presets import PresetStore
from vrut_lite.app.widgets import Chooser, aligned_form, faint_label, make_timer
from vrut_lite.kernel.messages import SetSetting
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.quantities import figure

_UPS = {"y": "+Y", "z": "+Z"}
_UNITS = {
    1.0: "metres",
    0.01: "centimetres",
    0.001: "millimetres",
    0.0254: "inches",
    0.3048: "feet",
}
_STEP_MS = 40
_SIZE = " \N{MULTIPLICATION SIGN} "


class ScenePanel(ModulePanel):
    """Facts of the open file above the scene's settings; a choice reopens the file."""

    def __init__(self, session: Session, module: str, presets: PresetStore):
        super().__init__(session, module, presets)
        self._opened: LoadScene | None = None
        self.extent = faint_label("opening\N{HORIZONTAL ELLIPSIS}", wraps=True)
        self.up, self.unit, self.camera = Chooser(), Chooser(), Chooser()
        self.variant = Chooser()
        self.play = QPushButton("Play")
        self.play.setCheckable(True)
        self.play.hide()
        self.play.setAccessibleName("Play the animations")
        self.play.setToolTip("Let the file's animations run at their own pace")
        self._steps = make_timer(self, _STEP_MS, self._step)
        self._duration_s = 0.0
        self._since = (0.0, 0.0)
        self.notices = faint_label(wraps=True)
        self._lay_out_file()
        session.listen(SceneOpened, self._show_file)

    def _lay_out_file(self) -> None:
        form = self._form = aligned_form()
        form.addRow("Size", self.extent)
        for title, box, tip in (
            ("Up", self.up, "The file's vertical axis"),
            ("Unit", self.unit, "The length of the file's unit"),
            ("Camera", self.camera, "The file's own cameras"),
            ("Variant", self.variant, "Other materials that the file has"),
        ):
            box.setToolTip(tip)
            box.setAccessibleName(title)
            box.setEnabled(False)
            form.addRow(title, box)
        form.addRow("", self.play)
        form.addRow(self.notices)
        for axis, title in _UPS.items():
            self.up.addItem(title, axis)
        for metres, title in _UNITS.items():
            self.unit.addItem(title, metres)
        self.up.activated.connect(lambda _: self._place(up=self.up.currentData()))
        self.unit.activated.connect(lambda _: self._place(metres_per_unit=self.unit.currentData()))
        self.camera.activated.connect(lambda _: self._open(camera=self.camera.currentText()))
        self.variant.activated.connect(lambda _: self._open(variant=self.variant.currentData()))
        self.play.toggled.connect(self._run)
        column = self.layout()
        assert isinstance(column, QVBoxLayout)
        column.insertLayout(1, form)

    def _run(self, on: bool) -> None:
        """Let the animations run from where they stand, or hold them."""
        if on:
            stands_at = self._module.values["animation_time_s"]
            assert isinstance(stands_at, float)
            self._since = (perf_counter(), stands_at)
            self._session.send(SetSetting(module=self._name, name="animation", value="time"))
            self._steps.start()
        else:
            self._steps.stop()

    def _step(self) -> None:
        started_s, from_s = self._since
        time_s = (from_s + perf_counter() - started_s) % self._duration_s
        self._session.send(SetSetting(module=self._name, name="animation_time_s", value=time_s))

    def _place(self, **changed: object) -> None:
        if self._opened is not None:
            placement = msgspec.structs.replace(self._opened.placement, **changed)
            self._open(placement=placement)

    def _open(self, **changed: object) -> None:
        if self._opened is not None:
            self._session.send(msgspec.structs.replace(self._opened, **changed))

    def _show_file(self, scene: SceneOpened) -> None:
        if scene.opened is None or scene.opened == self._opened:
            return
        self._duration_s = scene.animation_s
        self.play.setChecked(False)
        self.play.setVisible(scene.animation_s > 0.0)
        self._opened = scene.opened
        lengths = (upper - lower for lower, upper in zip(scene.lower_m, scene.upper_m, strict=True))
        self.extent.setText(
            f"{_SIZE.join(figure(length) for length in lengths)} m, {scene.triangles:,} triangles"
        )
        self.up.setCurrentIndex(self.up.findData(scene.opened.placement.up))
        metres = scene.opened.placement.metres_per_unit
        if self.unit.findData(metres) < 0:
            self.unit.addItem(f"{metres:g} m", metres)
        self.unit.setCurrentIndex(self.unit.findData(metres))
        self.camera.clear()
        self.camera.addItems(scene.cameras)
        self.camera.setCurrentText(scene.opened.camera)
        self.variant.clear()
        if scene.variants:
            self.variant.addItem("Default", "")
        for name in scene.variants:
            self.variant.addItem(name, name)
        self.variant.setCurrentIndex(self.variant.findData(scene.opened.variant))
        for box in (self.up, self.unit, self.camera, self.variant):
            box.setEnabled(box.count() > 0)
        for box in (self.camera, self.variant):
            self._form.setRowVisible(box, box.count() > 0)
        self.notices.setText("\n".join(scene.notices))
