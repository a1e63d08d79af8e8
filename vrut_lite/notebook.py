"""Scenes in a notebook: a scene under an hour shows itself, and has a slider of the hour."""

import gc
from datetime import datetime
from typing import TYPE_CHECKING, Any, Self
from weakref import ref

import msgspec

from vrut_lite.arguments import as_number
from vrut_lite.errors import UserError
from vrut_lite.geometry.preview import captioned_html, png
from vrut_lite.lazy import lazy
from vrut_lite.pictures.picture import Picture
from vrut_lite.place_time import time_zone_at
from vrut_lite.project import Project, in_words, project_of_path
from vrut_lite.studio.scene_pictures import ScenePlan, SceneShot, SceneStudio

if TYPE_CHECKING:
    from vrut_lite.hour_slider import HourSlider

# It needs the extra `notebook`.
_slider = lazy("vrut_lite.hour_slider:HourSlider")

_SIZE = (640, 360)
# Scenes that are open at a time, some 100 to 200 MB each: notebooks keep what a cell has shown.
_MOST_OPEN = 2
_open: "list[tuple[ref[LitScene], SceneStudio]]" = []


class LitScene:
    """A scene under the light of an hour, kept open: further hours take a fraction of a second.

    Only the two scenes used last are open; another one opens again when it is used.

    Args:
        scene: a glTF, OBJ or project file.
        **changes: fields of `Project`, such as at="2026-06-21T18:30", place="50.08,14.44",
            size=(640, 360).

    Raises:
        UserError: a field is unknown or none, or the scene cannot be opened.
    """

    def __init__(self, scene: str, **changes: Any):
        known = msgspec.structs.asdict(project_of_path(scene))
        known |= {"size": _SIZE} | changes
        try:
            self.project = msgspec.convert(known, Project)
        except msgspec.ValidationError as error:
            raise UserError(in_words(error)) from None
        self._shown: SceneShot | None = None
        self._is_closed = False
        _studio_of(self)

    def at(self, hour: float | str) -> Picture:
        """The picture of an hour: 18.5 on the same day, or an instant as "2026-06-21T18:30".

        Raises:
            UserError: there is no such hour, or the scene is closed.
        """
        if self._is_closed:
            raise UserError(f"the scene {self.project.scene} is closed: make its LitScene again")
        text = hour if isinstance(hour, str) else self._time_of(hour)
        self.project = msgspec.structs.replace(self.project, at=text)
        self._shown = _studio_of(self).shoot(self.project.instant())
        return self._shown.picture

    def slider(self) -> "HourSlider":
        """A widget: the picture, and a slider of the hour below it.

        Raises:
            UserError: the extra `notebook` is not installed.
        """
        try:
            slider = _slider.load()
        except ModuleNotFoundError:
            raise UserError(
                "the slider needs the extra `notebook`: pip install 'vrut-lite[notebook]'"
            ) from None
        now = self._local_now()
        widget: HourSlider = slider(
            lambda hour: png(self.at(hour).display), now.hour + now.minute / 60.0
        )
        return widget

    def close(self) -> None:
        """Free the GPU; the picture that is shown stays."""
        self._is_closed = True
        _keep([one for one in _open if one[0]() is not self])

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _time_of(self, hour: float) -> str:
        minutes = min(round(60.0 * as_number("hour", hour, 0.0, 24.0)), 24 * 60 - 1)
        return f"{self._local_now():%Y-%m-%d}T{minutes // 60:02d}:{minutes % 60:02d}"

    def _local_now(self) -> datetime:
        return self.project.instant().astimezone(time_zone_at(self.project.where()))

    def _last(self) -> SceneShot:
        if self._shown is None:
            self.at(self.project.at)
        assert self._shown is not None
        return self._shown

    def _repr_png_(self) -> bytes:
        """The picture of the last hour, for what shows no HTML."""
        return png(self._last().picture.display)

    def _repr_html_(self) -> str:
        """The picture for notebooks, with a caption of hour, sun and exposure."""
        return captioned_html(self._repr_png_(), self._last().caption)


def _studio_of(scene: LitScene) -> SceneStudio:
    """The scene's studio; frees those of scenes that are gone, or were used long ago."""
    mine = [one for one in _open if one[0]() is scene]
    others = [one for one in _open if one[0]() not in (None, scene)]
    _keep([*others[1 - _MOST_OPEN :], *mine])
    if not mine:
        _open.append((ref(scene), ScenePlan(scene.project).open()))
    return _open[-1][1]


def _keep(kept: "list[tuple[ref[LitScene], SceneStudio]]") -> None:
    closed = [studio for of, studio in _open if all(studio is not other for _, other in kept)]
    _open[:] = kept
    for studio in closed:
        studio.close()
    if closed:
        # Kernels and their modules refer to each other: else their arrays stay for a while.
        del closed, studio
        gc.collect()
