"""The picture as a file: PNG and JPEG as shown, EXR of its radiance, of any size."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import msgspec

from vrut_lite.app.engine.session import Session
from vrut_lite.app.engine.session_project import project_of
from vrut_lite.app.engine.stage import Stage
from vrut_lite.messages.picture import SetExposure
from vrut_lite.pictures.image_files import (
    DISPLAY_FORMATS,
    check_writable,
    picture_format,
    write_picture,
)
from vrut_lite.pictures.picture import Picture
from vrut_lite.project import Project
from vrut_lite.studio.picture_metadata import picture_metadata

Size = tuple[int, int]


def export_picture(
    session: Session, path: str | Path, then: Callable[[str], None], size: Size | None = None
) -> None:
    """Write the finished picture as the window exposes it; `then` gets a line about it.

    `size` is width and height in pixels, that of the window if it is None. An unknown suffix or a
    file that cannot be written is reported as the session's `problem`.
    """
    project = project_of(session)
    if size is not None:
        project = msgspec.structs.replace(project, size=size)
    session.ask(
        lambda stage: _written(stage, session.exposure_of(stage.state), path, project, size), then
    )


def _written(
    stage: Stage, exposure: SetExposure, path: str | Path, project: Project, size: Size | None
) -> str:
    picture_format(path, DISPLAY_FORMATS)
    check_writable(path)
    state = replace(stage.state, size_px=size or stage.state.size_px, exposure=exposure)
    picture = stage.draw(state, still=True)
    metadata = {
        **picture_metadata(project, stage.kernel),
        "exposureEv100": picture.ev100,
        "toneMap": project.exposure.tone_map,
    }
    write_picture(path, picture.radiance, picture.display, metadata)
    return f"{path}: {_size(picture)}, EV100 {picture.ev100:.1f}"


def _size(picture: Picture) -> str:
    height, width = picture.display.shape[:2]
    return f"{width} x {height} pixels"
