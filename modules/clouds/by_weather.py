"""The clouds of an hour of weather: a genus, its coverage, and the light that it lets through.

A file knows two numbers of an hour's clouds: the share of the hemisphere that they cover, and what
they leave of the light of a cloudless sky. Which genus has these two is ours, by the mean light
under each (Kasten and Czeplak 1980: 0.16 of it below nimbostratus, 0.18 below stratus,
0.27 below altostratus, 0.61 below cirrus, overcast each).
"""

import msgspec
import numpy as np

from clouds.genera import Genus
from clouds.settings import PREFIXES, CloudSettings, Layer, Passes
from vrut_lite.messages.cloudiness import CloudinessChanged

# Less cover is a clear sky; more is a closed layer.
_CLEAR, _CLOSED = 0.05, 0.95
# Heaps that are more than half of the sky stand in rolls. Light passes thinner layers than these.
_HEAPED = 0.6
_THIN_HEAPS, _THIN_ROLLS, _THIN_SHEET, _STRATUS, _RAIN = 0.97, 0.9, 0.8, 0.55, 0.22
# Cover of the zenith, and of the hemisphere, which is larger since the sides of heaps and rolls
# are visible (vrut_lite_lab.cloud_cover).
_ZENITH = 0.0, 0.35, 0.7, 1.0
_HEMISPHERE: dict[Genus, tuple[float, ...]] = {
    "Cu": (0.0, 0.61, 0.88, 1.0),
    "Sc": (0.0, 0.53, 0.80, 1.0),
}


def layers_under(
    settings: CloudSettings, cloudiness: CloudinessChanged | None
) -> tuple[Layer, ...]:
    """The settings' layers; what the low one leaves open is the weather's, if they follow it.

    Without a low genus the weather's layer is of the genus that the hour asks for, at its height.
    """
    if not settings.follow_weather or cloudiness is None:
        return settings.layers
    genus: Genus = settings.genus or genus_of(cloudiness)
    prefix = PREFIXES.get(genus, "")
    filled: dict[str, Genus | float] = {prefix + "genus": genus}
    if getattr(settings, prefix + "coverage") is None:
        filled[prefix + "coverage"] = coverage_of(cloudiness.cover, genus)
    layers = msgspec.structs.replace(settings, **filled).layers
    share = cloudiness.global_share
    if share is None or getattr(settings, prefix + "extinction_per_m") is not None:
        return layers
    passes = Passes(share, cloudiness.direct_share, cloudiness.sun_elevation_rad)
    return tuple(
        layer._replace(passes=passes) if layer.genus == genus else layer for layer in layers
    )


def genus_of(cloudiness: CloudinessChanged) -> Genus:
    """The genus of an hour's clouds."""
    cover, share = cloudiness.cover, cloudiness.global_share
    if share is None:
        share = 1.0 - 0.75 * cover**3.4
    if cover < _HEAPED:
        return "Cu" if share < _THIN_HEAPS else "Ci"
    if cover < _CLOSED:
        return "Sc" if share < _THIN_ROLLS else "Ci"
    if share < _RAIN:
        return "Ns"
    if share < _STRATUS:
        return "St"
    return "As" if share < _THIN_SHEET else "Cs"


def coverage_of(cover: float, genus: Genus) -> float:
    """Share of the zenith that is cloud, of a share of the hemisphere."""
    if cover < _CLEAR:
        return 0.0
    if cover >= _CLOSED:
        return 1.0
    if genus not in _HEMISPHERE:
        return cover
    return float(np.interp(cover, _HEMISPHERE[genus], _ZENITH))
