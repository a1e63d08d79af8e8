"""Radiance's skies: genssky, a precomputed spectral atmosphere, and gensky, CIE's clear sky."""

import resource
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from math import acos, atan2, cos, pi, radians, sin
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from platformdirs import user_cache_path

from vrut_lite.geometry.colour import integration_matrix
from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.study.peers.peer import NotHere, PeerShot
from vrut_lite_lab.study.peers.radiance_home import radiance_environment
from vrut_lite_lab.study.peers.views import HEIGHT, ON_GROUND, WIDTH, SkyViewpoint, of_picture

_GENSSKY_NM = tuple(float(nm) for nm in range(390, 771, 20))
# A summer day at mid-latitude, whose sun rises to 68 degrees: the hour gives the elevation.
_LATITUDE_DEG, _DAY = 45.0, ("6", "21")
_DECLINATION_RAD = 0.4093 * sin(2.0 * pi / 368.0 * (172 - 81))
_LONGEST_S = 1800.0


@dataclass
class Genssky:
    """genssky at its defaults in mid-latitude summer."""

    name: str = "genssky"
    title: str = "Radiance, genssky"
    air: str = "genssky"
    cannot: str = "observers aloft; a sun below -11.5°; aerosols other than its own"
    grey: bool = False
    _prepared_s: float = np.nan

    def shots(self, views: Sequence[SkyViewpoint]) -> dict[SkyViewpoint, PeerShot]:
        """From the ground."""
        tables = user_cache_path("vrut_lite", "vrut_lite") / "genssky"
        tables.mkdir(parents=True, exist_ok=True)
        made = not any(tables.glob("atmos_data/*"))
        found = {}
        with tempfile.TemporaryDirectory() as name:
            for view in (each for each in views if each in ON_GROUND):
                if made:
                    self._prepared_s, made = _genssky(view, 16, tables, name)[1], False
                sun, spent_s = _genssky(view, WIDTH, tables, name)
                picture = read_spectra(tables / "sky_sky.hsr") @ integration_matrix(_GENSSKY_NM)
                found[view] = PeerShot(of_picture(turned(picture, sun), view), spent_s)
        return found

    def prepared_s(self) -> float:
        """Its tables, where they were made now; it keeps them."""
        return self._prepared_s


def solar_hour(sun_deg: float) -> float:
    """The morning's solar time at which Radiance's own formulas put the sun there."""
    latitude = radians(_LATITUDE_DEG)
    up = sin(latitude) * sin(_DECLINATION_RAD) - sin(radians(sun_deg))
    return 12.0 / pi * acos(up / (cos(latitude) * cos(_DECLINATION_RAD)))


def _genssky(view: SkyViewpoint, width: int, tables: Path, folder: str) -> tuple[FloatArray, float]:
    """The sun's direction (3,) and CPU seconds; the picture lies in the folder."""
    hour = f"+{solar_hour(view.sun_deg):.6f}"
    place = ["-a", str(_LATITUDE_DEG), "-o", "0", "-m", "0", "-n", "1"]
    told, spent_s = _run(
        ["genssky", *_DAY, hour, *place, "-p", str(tables), "-r", str(width), "-f", "sky"], folder
    )
    lines = told.splitlines()
    at = next((n for n, line in enumerate(lines) if line.startswith("solar source")), None)
    if at is None:
        # Without a sun: a sky of the night's side, east by the formula of the hour.
        return _sun_of_hour(view.sun_deg), spent_s
    return np.array([float(word) for word in lines[at + 3].split()[1:4]]), spent_s


def _sun_of_hour(sun_deg: float) -> FloatArray:
    """East, north, up."""
    angle = (solar_hour(sun_deg) - 12.0) * pi / 12.0
    latitude, d = radians(_LATITUDE_DEG), _DECLINATION_RAD
    east = -cos(d) * sin(angle)
    north = sin(d) * cos(latitude) - cos(d) * sin(latitude) * cos(angle)
    return np.array([east, north, sin(radians(sun_deg))])


def turned(picture: FloatArray, sun: FloatArray) -> FloatArray:
    """The panorama with its sun in the middle, linear between columns.

    Radiance's columns rise counter-clockwise from the west; mirrored, as skies are about their sun.
    """
    width = picture.shape[1]
    shift = atan2(sun[1], sun[0]) / (2.0 * pi) * width
    low = int(np.floor(shift))
    part = shift - low
    return (1.0 - part) * np.roll(picture, -low, axis=1) + part * np.roll(picture, -low - 1, axis=1)


def read_spectra(path: Path) -> FloatArray:
    """Radiance (rows, columns, 20), shortest wavelength first, of an uncompressed .hsr file.

    Raises:
        NotHere: it is not as Radiance 6 writes it.
    """
    content = path.read_bytes()
    head, _, rest = content.partition(b"\n\n")
    size, _, body = rest.partition(b"\n")
    words = size.split()
    if b"NCOMP=20" not in head or len(words) != 4:
        raise NotHere("genssky wrote a file that is not understood")
    rows, columns = int(words[1]), int(words[3])
    if len(body) != rows * columns * 21:
        raise NotHere("genssky wrote a compressed file, which is not read here")
    pixels: NDArray[np.uint8] = np.frombuffer(body, np.uint8).reshape(rows, columns, 21)
    scale = np.ldexp(1.0, pixels[..., 20].astype(int) - 136)
    values = (pixels[..., :20] + 0.5) * scale[..., None]
    return np.asarray(np.where(pixels[..., 20:] > 0, values, 0.0))[..., ::-1]


@dataclass
class Gensky:
    """gensky's clear sky of CIE, without colour."""

    name: str = "gensky"
    title: str = "Radiance, gensky (CIE clear)"
    air: str = "continental"
    cannot: str = "colour; a sun below 0°; observers aloft; any atmosphere"
    grey: bool = True

    def shots(self, views: Sequence[SkyViewpoint]) -> dict[SkyViewpoint, PeerShot]:
        """From the ground, the sun up; every pixel by rtrace."""
        found = {}
        towards = lat_long_directions(HEIGHT)[..., [0, 2, 1]] * (1.0, -1.0, 1.0)
        rows = np.concatenate([np.zeros_like(towards), towards], axis=-1).reshape(-1, 6)
        rays = rows.astype("f4").tobytes()
        with tempfile.TemporaryDirectory() as name:
            for view in (each for each in views if each in ON_GROUND and each.sun_deg > 0.0):
                # An azimuth of 180 degrees west of south is north.
                sky, first_s = _run(["gensky", "-ang", str(view.sun_deg), "180", "-s"], name)
                glow = "skyfunc glow sky\n0\n0\n4 1 1 1 0\nsky source dome\n0\n0\n4 0 0 1 180\n"
                (Path(name) / "sky.rad").write_text(f"{sky}\n{glow}")
                octree, next_s = _run(["oconv", "sky.rad"], name, text=False)
                (Path(name) / "sky.oct").write_bytes(octree)
                seen, last_s = _run(
                    ["rtrace", "-h", "-fff", "-ab", "0", "sky.oct"], name, rays, text=False
                )
                picture = np.frombuffer(seen, np.float32).reshape(HEIGHT, WIDTH, 3)
                found[view] = PeerShot(of_picture(picture, view), first_s + next_s + last_s)
        return found

    def prepared_s(self) -> float:
        """Nothing."""
        return 0.0


def _run(command: list[str], folder: str, told: bytes | None = None, text: bool = True):  # type: ignore[no-untyped-def]
    """What a program writes, as text or bytes, and the CPU seconds of it."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        command,
        cwd=folder,
        env=radiance_environment(),
        input=told,
        capture_output=True,
        timeout=_LONGEST_S,
        check=False,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        last = (done.stderr.decode(errors="replace").strip().splitlines() or ["no message"])[-1]
        raise NotHere(f"{command[0]} failed: {last}")
    spent_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return (done.stdout.decode() if text else done.stdout), spent_s
