"""Our irradiance on level grids against Radiance's, under the same sky: a table.

    python -m vrut_lite_lab.radiance.table [--rays N] [SCENE ...]

Prague, 21 June, Hosek and Wilkie's sky of turbidity 3 over ground of albedo 0.1. Radiance is given
the scene's triangles as Lambert's, the sky as data, the sun, and the open ground beyond the map. It
interpolates nothing. Light is that of all but the sun's own rays, which the frame draws by itself.
"At points" are rays of their own, as many as Radiance's, that end on patches of the light map; "on
the map" are texels below the grid that face up, as the frame shows them at the usual quality,
against Radiance at their middle. Differences are shares of the grid's mean. It needs the extra
`radiance`.
"""

import argparse

from vrut_lite_lab.radiance.grids import GRIDS, compared_hours
from vrut_lite_lab.radiance.irradiance import RadianceEffort

SKY = "dynamic_skylight"
HOURS = ("12:30", "20:00")
HEADER = [
    "| scene, hour, sky | points | mean | rms | most | on the map | mean | rms |",
    "|---|---:|---:|---:|---:|---:|---:|---:|",
]
_TEXELS = 60


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    names = [grid.scene for grid in GRIDS]
    parser.add_argument("scenes", nargs="*", default=names, help=f"of {', '.join(names)}")
    parser.add_argument("--rays", type=int, default=RadianceEffort.rays, help="from each point")
    chosen = parser.parse_args()
    effort = RadianceEffort(chosen.rays)
    print("\n".join(HEADER), flush=True)
    for grid in GRIDS:
        if grid.scene not in chosen.scenes:
            continue
        for caption, baked, hour in compared_hours(grid, SKY, HOURS):
            points = baked.at_points(grid.places_m, hour, effort)
            texels = baked.on_texels(grid, _TEXELS, hour, effort)
            cells = [
                f"{points.free}", f"{points.mean:+.2%}", f"{points.rms:.2%}", f"{points.most:.1%}",
                f"{texels.free}", f"{texels.mean:+.2%}", f"{texels.rms:.2%}",
            ]  # fmt: skip
            print(f"| {caption} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
