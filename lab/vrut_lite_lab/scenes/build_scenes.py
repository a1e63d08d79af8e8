"""Make the scenes in `scenes/`.

    python -m vrut_lite_lab.scenes.build_scenes [SET ...] [--into FOLDER]

Sets are `small` (sundial, street, spheres, pavilion), `work` (scenes that need little work) and
`large` (hall, satellite, terrain; eroding the terrain takes 20 s); all of them if none is named.
The bytes are the same each time and on every machine.
"""

import argparse
from pathlib import Path

from vrut_lite_lab.checkout import ROOT
from vrut_lite_lab.scenes import hall, pavilion, satellite, spheres, street, sundial, terrain, work

SCENES = ROOT / "scenes"
# Each set: its folder below `scenes/`, and the scripts that return its files' names and bytes.
SETS = {
    "small": ("", (sundial, street, spheres, pavilion)),
    "work": ("work", (work,)),
    "large": ("large", (hall, satellite, terrain)),
}


def main() -> None:
    """Write the chosen sets into scenes/, or all of them into one FOLDER."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("sets", nargs="*", metavar="SET", help=f"of {', '.join(SETS)}")
    parser.add_argument("--into", type=Path, metavar="FOLDER", help="instead of scenes/")
    asked = parser.parse_args()
    if unknown := set(asked.sets) - set(SETS):
        parser.error(f"there is no set {min(unknown)!r}, only {', '.join(SETS)}")
    for name in asked.sets or SETS:
        subfolder, scripts = SETS[name]
        folder = asked.into or SCENES / subfolder
        folder.mkdir(parents=True, exist_ok=True)
        for script in scripts:
            for file, data in script.build().items():
                (folder / file).write_bytes(data)
                print(f"{file}: {len(data)} bytes")


if __name__ == "__main__":
    main()
