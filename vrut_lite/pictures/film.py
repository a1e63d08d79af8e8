"""Films of sRGB pictures: MP4 (H.264, by PyAV, the extra `film`) and animated WebP (by Pillow)."""

import os
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.errors import UserError
from vrut_lite.write_atomic import atomic_output

MP4, WEBP = ".mp4", ".webp"
FILM_FORMATS = (MP4, WEBP)
# Quality of H.264, above its default because skies band, and of WebP (100 is best).
_CRF, _WEBP_QUALITY = "17", 85

Pixels = NDArray[np.uint8]


def film_format(path: str | os.PathLike[str]) -> str:
    """The suffix of a film that can be written here.

    Raises:
        UserError: another suffix, or MP4 without PyAV.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in FILM_FORMATS:
        raise UserError(f"cannot write {path}: films are {' or '.join(FILM_FORMATS)}")
    if suffix == MP4:
        try:
            import av  # noqa: F401
        except ImportError:
            raise UserError(
                "films as MP4 need PyAV: pip install 'vrut-lite[film]', or write a .webp"
            ) from None
    return suffix


def write_film(
    path: str | os.PathLike[str], pictures: Iterable[Pixels], pictures_a_second: int
) -> None:
    """Write pictures (h, w, 3) of one size, sRGB, one after another.

    Raises:
        UserError: another suffix, MP4 without PyAV, no picture, or the file cannot be written.
    """
    suffix = film_format(path)
    found = iter(pictures)
    first = next(found, None)
    if first is None:
        raise UserError(f"cannot write {path}: a film needs a picture")
    with atomic_output(path) as beside:
        write = _write_mp4 if suffix == MP4 else _write_webp
        write(beside, chain([first], found), pictures_a_second)


def film_of_files(path: Path, files: Sequence[Path], pictures_a_second: int) -> None:
    """Write a film of picture files that Pillow reads."""
    write_film(path, _pixels_of(files), pictures_a_second)


def _pixels_of(files: Sequence[Path]) -> Iterator[Pixels]:
    for file in files:
        with Image.open(file) as image:
            yield np.asarray(image.convert("RGB"))


def _write_mp4(path: Path, pictures: Iterable[Pixels], rate: int) -> None:
    import av

    with av.open(str(path), "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=rate, options={"crf": _CRF})
        stream.pix_fmt = "yuv420p"
        for picture in pictures:
            # Colour at half size takes even numbers of pixels.
            height, width = (side // 2 * 2 for side in picture.shape[:2])
            if not stream.codec_context.is_open:
                stream.height, stream.width = height, width
            even = np.ascontiguousarray(picture[:height, :width])
            container.mux(stream.encode(av.VideoFrame.from_ndarray(even, format="rgb24")))
        container.mux(stream.encode())


def _write_webp(path: Path, pictures: Iterable[Pixels], rate: int) -> None:
    first, *others = (Image.fromarray(picture) for picture in pictures)
    first.save(
        path,
        format="WEBP",
        save_all=True,
        append_images=others,
        duration=round(1000 / rate),
        loop=0,
        quality=_WEBP_QUALITY,
    )
