"""Make the scenes anew: `python scenes/build_scenes.py [FOLDER]`.

Without a folder they go beside this script. The bytes are the same each time and everywhere.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from scenes import pavilion, spheres, street, sundial


def build_scenes() -> dict[str, bytes]:
    """All files of all scenes: names and bytes."""
    return {
        name: data
        for scene in (sundial, street, spheres, pavilion)
        for name, data in scene.build().items()
    }


def main(folder: Path) -> None:
    """Write the scenes into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in build_scenes().items():
        (folder / name).write_bytes(data)
        print(f"{name}: {len(data)} bytes")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
