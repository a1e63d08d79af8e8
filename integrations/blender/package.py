"""Zips the add-on for Blender's "Install from Disk": python package.py [FILE.zip].

Without a name it is out/vrut_lite_daylight.zip.
"""

import sys
import zipfile
from pathlib import Path

HERE = Path(__file__).parent
ADDON = HERE / "vrut_lite_daylight"


def package(path: Path) -> None:
    """Write the extension's archive."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(ADDON.iterdir()):
            if file.suffix in (".py", ".toml"):
                archive.write(file, file.name)


if __name__ == "__main__":
    usual = HERE.parents[1] / "out" / "vrut_lite_daylight.zip"
    package(Path(sys.argv[1]) if len(sys.argv) > 1 else usual)
