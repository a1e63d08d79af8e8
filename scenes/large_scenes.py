"""Scenes for the air, from a hall to the planet: `python scenes/large_scenes.py [FOLDER]`.

Without a folder they go to `large/` beside this script, where their project files are; the bytes
are the same each time and everywhere. `vrut-lite demo` leaves them out: four megabytes to draw.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from scenes import hall, satellite, terrain


def main(folder: Path) -> None:
    """Write the scenes into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in {**hall.build(), **satellite.build(), **terrain.build()}.items():
        (folder / name).write_bytes(data)
        print(f"{name}: {len(data)} bytes")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent / "large")
