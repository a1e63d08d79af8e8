"""The picture as a file: PNG as shown, EXR of its radiance."""

from pathlib import Path

from vrut_lite.app.engine.stage import Stage
from vrut_lite.commands.picture_metadata import picture_metadata
from vrut_lite.pictures.image_files import check_writable, picture_format, write_exr, write_png
from vrut_lite.pictures.picture import Picture
from vrut_lite.project import Project

FORMATS = (".png", ".exr")


def export_picture(stage: Stage, path: str | Path, project: Project) -> str:
    """Draw the finished picture and write it, on the engine's thread; a sentence on what it is.

    Raises:
        UserError: the name has another ending, or the file cannot be written.
    """
    suffix = picture_format(path, FORMATS)
    check_writable(path)
    picture = stage.draw(stage.state.size_px, still=True)
    metadata = {
        **picture_metadata(project, stage.kernel),
        "exposureEv100": picture.ev100,
        "toneMap": project.exposure.tone_map,
    }
    if suffix == ".exr":
        write_exr(path, picture.radiance, metadata)
    else:
        write_png(path, picture.display, metadata)
    return f"{path}: {_size(picture)}, EV100 {picture.ev100:.1f}"


def _size(picture: Picture) -> str:
    height, width = picture.display.shape[:2]
    return f"{width} x {height} pixels"
