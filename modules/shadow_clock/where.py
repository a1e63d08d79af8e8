"""`vrut-lite where`: the places on Earth where a shadow falls as it was measured."""

import json
import math
import re
from pathlib import Path
from typing import Any

import click

from shadow_clock.options import shadow_options
from vrut_lite.errors import UserError
from vrut_lite.headless import FiniteRange, write_png
from vrut_lite.lazy import lazy
from vrut_lite.place_time import Place, parse_instant
from vrut_lite.write_atomic import atomic_output, check_writable

# Numpy and the ephemeris take a third of a second to import, which --help need not wait for.
_places = lazy("shadow_clock.places")
_measured = lazy("shadow_clock.measured_shadow")
_geojson = lazy("shadow_clock.geojson")
_map_picture = lazy("shadow_clock.map_picture")

_OFFSET = re.compile(r"(Z|[+-]\d\d(:?\d\d)?)$", re.ASCII | re.IGNORECASE)
_LONGEST_ERROR_S = 43_200.0


@click.command(name="where")
@shadow_options
@click.option(
    "--at",
    required=True,
    metavar="TIME",
    help="ISO time with its offset from UTC, as 2026-06-21T15:00Z.",
)
@click.option(
    "--time-error-s",
    type=FiniteRange(0.0, _LONGEST_ERROR_S),
    default=0.0,
    show_default=True,
    metavar="S",
    help="How far the time may be off, in seconds.",
)
@click.option("-o", "--output", metavar="LINE.geojson", help="Write line, band and places.")
@click.option("--map", "map_file", metavar="MAP.png", help="Draw them on a map of the world.")
def where(
    at: str,
    time_error_s: float,
    output: str | None,
    map_file: str | None,
    bearing_deg: float | None,
    length_ratio: float | None,
    bearing_error_deg: float,
    ratio_error: float,
) -> None:
    """Tell where on Earth a shadow has the measured length at an instant.

    The places lie on a circle around the point below the sun. The shadow's bearing cuts it down to
    one or two of them.

    Example: vrut-lite where --at 2026-06-21T15:00Z --length-ratio 1.2 -o line.geojson

    Example: vrut-lite where --at 2026-06-21T15:00Z --length-ratio 1.2 --shadow-bearing 41
    --time-error-s 600 --map map.png
    """
    if length_ratio is None:
        raise UserError("without --length-ratio there is no circle: name it")
    if not _OFFSET.search(at.strip()):
        raise UserError(f"--at {at} has no offset, and no place is known: write it as {at}Z")
    instant = parse_instant(at, Place(0.0, 0.0))
    files = [(output, ".geojson"), (map_file, ".png")]
    wanted = [(Path(name), suffix) for name, suffix in files if name is not None]
    for path, suffix in wanted:
        if path.suffix.lower() != suffix:
            raise UserError(f"cannot write {path}: its name ends with {suffix}")
    for path, _ in wanted:
        check_writable(path)
    shadow = _measured.MeasuredShadow(bearing_deg, length_ratio, bearing_error_deg, ratio_error)
    circle = _places.ShadowCircle(shadow, instant, time_error_s)
    line, edges = circle.line(), circle.edges()
    places = [] if bearing_deg is None else circle.places()
    click.echo(_told(circle))
    for place in places:
        click.echo(
            f"{place.latitude_deg:.3f},{place.longitude_deg:.3f}: within {place.error_km:,.0f} km"
        )
    if bearing_deg is not None and not places:
        click.echo(f"none of them has shadows to {bearing_deg % 360.0:g} degrees at that time")
    if output is not None:
        said = {"at": instant.isoformat(), "length_ratio": length_ratio}
        features = [_geojson.line_feature(line, what="line", **said)]
        features += [_geojson.line_feature(edge, what="edge of the band", **said) for edge in edges]
        features += [_geojson.place_feature(place, what="place", **said) for place in places]
        text = json.dumps(_geojson.collection(features), separators=(",", ":"))
        with atomic_output(output) as target:
            target.write_text(text + "\n", encoding="utf-8")
    if map_file is not None:
        write_png(map_file, _map_picture.map_picture(circle, line, places))


def _told(circle: Any) -> str:
    """The circle in words."""
    latitude, longitude = circle.below_sun
    middle, near, far = circle.radii_km()
    elevation = math.degrees(circle.shadow.elevation_rad)
    return (
        f"the sun is {elevation:.2f} degrees high on a circle {middle:,.0f} km around "
        f"{latitude:.3f},{longitude:.3f}, and fits from {near:,.0f} to {far:,.0f} km"
    )
