"""Both sky models beside three photographs of the sky (docs/photographs.md).

    python -m vrut_lite_lab.study.photographs PHOTO_FOLDER OUT_FOLDER

Reads park.exr, sunrise.exr and dawn.exr (lat-long, linear RGB, +Y up; by Poly Haven, CC0), masks
what is not clear sky, finds the sun, fits turbidity, exposure and gains, and writes photo_NAME.jpg
(strips) and photo_NAME_profile.png for each. Prints two Markdown tables: the fits, and Bruneton's
sky in other air.
"""

import sys
from pathlib import Path

from vrut_lite.errors import UserError
from vrut_lite_lab.study.photographs.comparison import (
    AIR_HEADER,
    HEADER,
    air_rows,
    compare,
    read_photograph,
    table_rows,
)
from vrut_lite_lab.study.photographs.figures import profile_figure, strips

PHOTOGRAPHS = ("park", "sunrise", "dawn")


def main(photo_folder: Path, out_folder: Path) -> None:
    """Fit, print and draw all photographs, then fit Bruneton's sky in other air."""
    out_folder.mkdir(parents=True, exist_ok=True)
    print(HEADER)
    comparisons = {}
    for name in PHOTOGRAPHS:
        comparison = compare(read_photograph(photo_folder / f"{name}.exr"))
        comparisons[name] = comparison
        print("\n".join(table_rows(name, comparison)), flush=True)
        strips(comparison).save(out_folder / f"photo_{name}.jpg", quality=85)
        profile_figure(comparison, out_folder / f"photo_{name}_profile.png")
    print(f"\n{AIR_HEADER}")
    for name, comparison in comparisons.items():
        print("\n".join(air_rows(name, comparison)), flush=True)


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1]), Path(sys.argv[2]))
    except UserError as error:
        sys.exit(str(error))
