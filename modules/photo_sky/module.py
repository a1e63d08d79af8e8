"""The module `photo_sky`: a photograph of the sky lights the scene.

Its sun does not follow the clock. Where it holds the slot `sun` too, it posts the direction of the
photograph's sun, so that all consumers have the sun that casts the shadows.
"""

from pathlib import Path
from typing import ClassVar, NamedTuple

import numpy as np

from photo_sky.light import RADIUS_RAD, PhotoLight
from photo_sky.photograph import Photograph, photograph_of, with_sun
from photo_sky.read_panorama import read_panorama
from photo_sky.settings import PhotoSettings
from vrut_lite import __version__
from vrut_lite.errors import UserError
from vrut_lite.geometry.frames import enu_from_world
from vrut_lite.kernel.messages import ClockMoved, SlotChanged
from vrut_lite.kernel.module import Link, Manifest, handles
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sun import SunMoved
from vrut_lite.sky.sky_module import SkyModule
from vrut_lite.sky.sky_of_hour import SkyInputs

NAME = "photo_sky"
_BLACK = (0.0, 0.0, 0.0)


class PhotoQuality(NamedTuple):
    """A cube's edge in texels."""

    cube_size: int


class PhotoSky(SkyModule):
    """The sky of a panorama, and its sun."""

    manifest = Manifest(
        name=NAME,
        title="Photograph (sun stands still)",
        version=__version__,
        provides=("sun", "sky"),
        stand_in=False,
    )
    settings_type = PhotoSettings
    settings: PhotoSettings
    follows_sun: ClassVar[bool] = False

    def __init__(self, link: Link, settings: PhotoSettings):
        super().__init__(link, settings)
        self._photograph: Photograph | None = None
        # Luminance of the value 1, by the file itself.
        self._said_cd_m2 = 1.0
        # The file that was read last, also if in vain.
        self._read = ""

    def quality(self, tolerance: float) -> PhotoQuality:
        """Sharp enough for the photograph's clouds."""
        return PhotoQuality(int(np.clip(25.0 / tolerance, 64, 1024)))

    def light(self, hour: SkyInputs, quality: PhotoQuality, prepared: None) -> PhotoLight:
        """The photograph's, whatever the hour."""
        own = self.settings
        return PhotoLight(
            self._photograph,
            np.radians(own.photo_rotation_deg),
            self._said_cd_m2 if own.photo_cd_m2 is None else own.photo_cd_m2,
            own.photo_lux,
            self.ground_unless(own.photo_albedo).rgb,
        )

    @handles(ClockMoved)
    @handles(SetPlace)
    def inputs_changed(self, _message: ClockMoved | SetPlace) -> None:
        """The first of them may be the first sign of life."""
        self._show()

    @handles(SlotChanged)
    def chosen(self, message: SlotChanged) -> None:
        """This sky is chosen, or this sun.

        Raises:
            UserError: there is no photograph, or it cannot be read.
        """
        if message.name in ("sun", "sky") and message.holder == NAME:
            self._show()
            if not self.settings.photo:
                raise UserError(
                    "photo_sky has no picture: set photo to an EXR, HDR or glTF panorama"
                )

    def settings_changed(self, name: str) -> None:
        """Another photograph, or the same in another way."""
        self._show()
        super().settings_changed(name)

    def _show(self) -> None:
        """Read the photograph if it is another, and tell where its sun stands."""
        if not (self.link.holds("sky") or self.link.holds("sun")):
            return
        path = self.settings.photo
        if path != self._read:
            self._read, self._photograph = path, None
            if path:
                panorama = read_panorama(Path(path).expanduser())
                self._photograph = (
                    photograph_of(panorama.pixels)
                    if panorama.sun is None
                    else with_sun(panorama.pixels, panorama.sun, panorama.cd_m2_per_unit)
                )
                self._said_cd_m2 = panorama.cd_m2_per_unit
        self._tell_sun()

    def _tell_sun(self) -> None:
        place, own = self.link.last(SetPlace), self.settings
        if not self.link.holds("sun"):
            return
        light = PhotoLight(self._photograph, np.radians(own.photo_rotation_deg), 1.0, None, _BLACK)
        # Without a sun in the picture: straight above, where no night begins.
        direction = light.sun_direction or (0.0, 1.0, 0.0)
        east, north, up = enu_from_world(
            np.array(direction), 0.0 if place is None else place.north_offset_rad
        )
        elevation = float(np.arcsin(np.clip(up, -1.0, 1.0)))
        told = SunMoved(
            direction=direction,
            azimuth_rad=float(np.arctan2(east, north) % (2.0 * np.pi)),
            elevation_rad=elevation,
            apparent_elevation_rad=elevation,
            visible_disc_fraction=float(np.clip(0.5 + 0.5 * elevation / RADIUS_RAD, 0.0, 1.0)),
        )
        if self.link.last(SunMoved) != told:
            self._post(told)
