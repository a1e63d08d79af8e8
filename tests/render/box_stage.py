"""A box on the ground, light on it, and a camera: what tests of all backends do alike."""

import numpy as np
from stateful_backend import opened

from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.messages.ground_disc import GroundDisc

SIZE = 32


def uniform_sky(radiance):
    return np.full((6, SIZE, SIZE, 3), radiance, float)


def show_box(backend, path, albedo=0.5):
    backend.change(scene=opened(path, GroundDisc((0.0, 0.0), 0.0, 200.0)))
    backend.change(ground_albedo_rgb=(albedo,) * 3)


def sun_at(azimuth_deg, elevation_deg):
    angles = np.radians([azimuth_deg, elevation_deg])
    return tuple(world_from_enu(direction_from_angles(*angles)))
