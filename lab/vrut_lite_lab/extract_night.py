"""Write the stars, the Milky Way and the tables of publications that night_sky carries.

Run once: `npm pack d3-celestial@0.7.35`, unpack it, then

    python -m vrut_lite_lab.extract_night PACKAGE_FOLDER BRIGHT_STARS_NPZ

Sources: d3-celestial (BSD-3-Clause, Olaf Frohn; its notice is in the module's data): `stars.8.json`
(positions J2000, V, B-V of the XHIP catalogue) and `mw.json` (outlines of the Milky Way at five
levels). It has no proper motions: those of the fastest bright stars are numbers of the Bright Star
Catalogue (Hoffleit and Warren 1991, ADC V/50, public domain), matched by place and magnitude.
"""

import json
import sys
from pathlib import Path

import numpy as np
from matplotlib.path import Path as Outline
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from vrut_lite_lab.checkout import ROOT

TARGET = ROOT / "modules" / "night_sky" / "data" / "night.npz"
# Proper motion (arcsec a year) from which a star's is kept: 0.01 deg in 100 years.
LEAST_MOTION_ARCSEC = 0.36
MATCH_DEG, MATCH_MAG = 0.012, 0.6
# Rows and columns of the Milky Way's map, and the blur that hides the five levels' steps.
MAP_SHAPE, BLUR_DEG = (90, 180), 3.0
# Where B-V is missing, that of a white star.
USUAL_B_MINUS_V = 0.3


def stars_of(package: Path) -> dict[str, NDArray[np.float64]]:
    """Right ascension and declination (deg), V and B-V, brightest first."""
    features = json.loads((package / "data" / "stars.8.json").read_text())["features"]
    place = np.array([feature["geometry"]["coordinates"] for feature in features])
    said = [feature["properties"] for feature in features]
    magnitude = np.array([float(one["mag"]) for one in said])
    colour = np.array([float(one["bv"] or USUAL_B_MINUS_V) for one in said])
    order = np.argsort(magnitude, kind="stable")
    return {
        "ra_deg": np.mod(place[order, 0], 360.0),
        "dec_deg": place[order, 1],
        "v_mag": magnitude[order],
        "b_minus_v": colour[order],
    }


def motions_of(
    stars: dict[str, NDArray[np.float64]], published: Path
) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Rows of the stars that move, and their motion (n, 2) in arcsec a year on the great circle."""
    bright = np.load(published)
    pm = np.stack([bright["pm_ra_arcsec"], bright["pm_dec_arcsec"]], axis=1)
    ours, theirs = (
        _unit(stars["ra_deg"], stars["dec_deg"]),
        _unit(bright["ra_deg"], bright["dec_deg"]),
    )
    rows, kept = [], []
    for star in np.flatnonzero(np.hypot(*pm.T) > LEAST_MOTION_ARCSEC):
        apart_deg = np.degrees(np.linalg.norm(ours - theirs[star], axis=1))
        fits = np.abs(stars["v_mag"] - bright["v_mag"][star]) < MATCH_MAG
        row = int(np.argmin(np.where(fits, apart_deg, 360.0)))
        if fits[row] and apart_deg[row] < MATCH_DEG and row not in rows:
            rows.append(row)
            kept.append(pm[star])
    return np.array(rows, np.int32), np.array(kept, np.float32)


def milky_way_of(package: Path) -> NDArray[np.float32]:
    """Share (rows, columns) of the brightest level, J2000: row 0 at dec +90, RA rising from 0."""
    features = json.loads((package / "data" / "mw.json").read_text())["features"]
    rows, columns = MAP_SHAPE
    dec = 90.0 - (np.arange(rows) + 0.5) * 180.0 / rows
    ra = (np.arange(columns) + 0.5) * 360.0 / columns
    longitude = np.mod(ra + 180.0, 360.0) - 180.0
    points = np.stack(np.meshgrid(longitude, dec), axis=-1).reshape(-1, 2)
    level = np.zeros(len(points))
    for feature in features:
        inside = np.zeros(len(points), bool)
        for polygon in feature["geometry"]["coordinates"]:
            for ring in polygon:
                # A ring inside a ring is a hole.
                inside ^= _within(np.array(ring), points)
        level += inside
    share = level.reshape(MAP_SHAPE) / len(features)
    blur = BLUR_DEG / 360.0 * columns
    return gaussian_filter(share, blur, mode=("nearest", "wrap")).astype(np.float32)


def _within(ring: NDArray, points: NDArray) -> NDArray[np.bool_]:
    """Whether points (n, 2) of longitude and latitude lie in a ring, which may go round the sky."""
    longitude = np.unwrap(ring[:, 0], period=360.0)
    outline = np.stack([longitude, ring[:, 1]], axis=1)
    if abs(longitude[-1] - longitude[0]) > 180.0:
        # Round the sky: all that lies south of it.
        corners = [[longitude[-1], -91.0], [longitude[0], -91.0]]
        outline = np.concatenate([outline, corners])
    inside = np.zeros(len(points), bool)
    for turn in (-720.0, -360.0, 0.0, 360.0, 720.0):
        inside ^= Outline(outline).contains_points(points + np.array([turn, 0.0]))
    return inside


def _unit(ra_deg: NDArray, dec_deg: NDArray) -> NDArray[np.float64]:
    ra, dec = np.radians(ra_deg), np.radians(dec_deg)
    return np.stack([np.cos(dec) * np.cos(ra), np.cos(dec) * np.sin(ra), np.sin(dec)], axis=-1)


def main(package: str, published: str) -> None:
    """Write the file."""
    stars = stars_of(Path(package))
    rows, motion = motions_of(stars, Path(published))
    np.savez_compressed(
        TARGET,
        ra_deg=stars["ra_deg"],
        dec_deg=stars["dec_deg"],
        v_mag=stars["v_mag"].astype(np.float32),
        b_minus_v=stars["b_minus_v"].astype(np.float32),
        moving=rows,
        motion_arcsec=motion,
        milky_way=np.round(milky_way_of(Path(package)) * 255.0).astype(np.uint8),
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
