"""The street under six skies of the weather, and the skies, on one sheet.

    python -m vrut_lite_lab.pictures.weather SHEET.webp YEAR.epw PANORAMA.exr

YEAR.epw is what `tests/epw_year.py` makes. Each picture is what `vrut-lite render` and
`vrut-lite sky` write with the options below.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

from vrut_lite_lab.pictures.drawing import SCENES, sheet

_SIZE, _SKY = (480, 270), (480, 120)
_COMMAND = "from vrut_lite.cli import main; main()"


def options(year: str, panorama: str) -> dict[str, list[str]]:
    """What is typed after each command, by caption."""
    hour = ["--weather", year, "--at"]
    still = ["--at", "2026-04-10T14:30", "--place", "50.1,14.4", "--sky", "weather_sky"]
    photo = ["--sky", "photo_sky", "--photo", panorama, "--photo-rotation-deg", "120"]
    return {
        "CIE 1, overcast": [*still, "--distribution", "cie-1"],
        "CIE 12, clear": [*still, "--distribution", "cie-12"],
        "A photograph of a park, 20,000 lux": [*photo, "--photo-lux", "20000"],
        "EPW year, 9 May: overcast": [*hour, "2026-05-09T14:30"],
        "EPW year, 9 April: clear": [*hour, "2026-04-09T14:30"],
        "EPW year, 2 April: partly cloudy": [*hour, "2026-04-02T14:30"],
    }


def drawn(options: list[str], folder: Path) -> np.ndarray:
    """The street, and below it the upper half of the sky, (h, w, 3) uint8."""
    street, sky = folder / "street.png", folder / "sky.png"
    size = "x".join(map(str, _SIZE))
    scene = str(SCENES / "street.toml")
    for command in (
        ["render", scene, "-o", str(street), "--size", size, *options],
        ["sky", "-o", str(sky), "--size", "256", *options],
    ):
        subprocess.run([sys.executable, "-c", _COMMAND, *command], check=True)
    whole = Image.open(sky).convert("RGB")
    half = whole.crop((0, 0, whole.width, whole.height // 2)).resize(_SKY)
    return np.concatenate([np.asarray(Image.open(street).convert("RGB")), np.asarray(half)])


def main(target: str, year: str, panorama: str) -> None:
    """Draw the sheet."""
    with tempfile.TemporaryDirectory() as folder:
        pictures = [
            (caption, drawn(typed, Path(folder)))
            for caption, typed in options(year, panorama).items()
        ]
    sheet(pictures, 3).save(target, quality=82)


if __name__ == "__main__":
    main(*sys.argv[1:])
