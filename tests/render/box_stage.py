"""A box on the ground, light on it, and a camera: what tests of all backends do alike."""

import numpy as np
from light_messages import light_messages

from vrut_lite.daylight.camera import MoveCamera
from vrut_lite.geometry.frames import direction_from_angles, world_from_enu
from vrut_lite.scene.ground_disc import GroundDisc
from vrut_lite.scene.loading import load_scene

SIZE = 32


def uniform_sky(radiance):
    return np.full((6, SIZE, SIZE, 3), radiance, float)


def light(backend, cube, **sun):
    background, sun_light, ambient = light_messages(cube, **sun)
    backend.set_background(background)
    backend.set_sun_light(sun_light)
    backend.set_ambient(ambient)


def show_box(backend, path, albedo=0.5):
    backend.show_scene(load_scene(path), GroundDisc((0.0, 0.0), 0.0, 200.0))
    backend.set_ground_albedo(np.full(3, albedo))


def look(backend, eye, target, field_of_view_rad=0.6):
    backend.set_camera(
        MoveCamera(eye_m=eye, target_m=target, vertical_field_of_view_rad=field_of_view_rad)
    )
    return backend.draw()


def sun_at(azimuth_deg, elevation_deg):
    angles = np.radians([azimuth_deg, elevation_deg])
    return tuple(world_from_enu(direction_from_angles(*angles)))
