"""A scene made ready for daylight numbers: its bake, its glass, its sensors and their matrix."""

import os
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from light_transport.bake import Bake
from light_transport.cached_cuts import kept_cut_texels
from light_transport.cached_rays import add_kept_rays
from light_transport.daylight_numbers.glass import Glass, glass_of, with_glazing
from light_transport.daylight_numbers.operator import Operator, operator_of
from light_transport.daylight_numbers.sensors import Sensors
from light_transport.daylight_numbers.work_planes import work_planes
from light_transport.giving_up import CancelCheck, always
from light_transport.jobs import first_rays
from light_transport.layout.layout import lay_out
from light_transport.surfaces.surfaces import surfaces_of
from light_transport.tolerance import quality_for
from vrut_lite.errors import GivenUp, UserError
from vrut_lite.messages.glazing import Glazing
from vrut_lite.messages.scene import SceneOpened

_MOST_THREADS = 4
# Of the tolerance of radiance, for rays of sensors: 1 % at its default.
RAYS_SHARE = 0.1


@dataclass(frozen=True, eq=False)
class Grid:
    """How work planes are found: `height_m` above floors, in cells of `step_m`."""

    height_m: float
    step_m: float


@dataclass(frozen=True, eq=False)
class Work:
    """All that an hour or a year is computed from."""

    bake: Bake
    glass: Glass
    sensors: Sensors
    operator: Operator


def baked(
    scene: SceneOpened,
    tolerance: float,
    share_of_texels: float = 1.0,
    go_on: CancelCheck = always,
    glazing: Mapping[str, Glazing] | None = None,
) -> Bake:
    """A scene's bake by all rays of a tolerance; kept on disk by its content.

    Raises:
        UserError: the scene has no surfaces.
        GivenUp: by `go_on`.
    """
    if not scene.triangles:
        raise UserError("the scene has no surfaces: there is nothing to measure in")
    quality = quality_for(tolerance)
    surfaces = surfaces_of(scene)
    if glazing:
        glass = glass_of(scene, surfaces, glazing)
        named = [material.name in glazing for material in scene.materials.all()]
        mesh_of_part = scene.geometry.part_mesh.values
        is_named = [named[scene.geometry.mesh(mesh).material] for mesh in mesh_of_part.tolist()]
        glazed = (surfaces.part >= 0) & np.append(is_named, False)[surfaces.part]
        surfaces = with_glazing(surfaces, glass, glazed)
    threads = min(os.cpu_count() or 1, _MOST_THREADS)
    texels = int(quality.texels * share_of_texels)
    layout = lay_out(scene, surfaces, None, texels, threads, go_on)
    sizes = quality.patch_texels, quality.bounces_left
    bake = Bake(surfaces, layout, threads, *sizes, cut=kept_cut_texels)
    # Patches follow from the first round, and so do kept rays: it is the module's own.
    for rays in (first_rays(bake.rows), quality.rays):
        if not add_kept_rays(bake, rays - bake.rays, lambda: _is_over(go_on)):
            raise GivenUp
        go_on()
    return bake


def _is_over(go_on: CancelCheck) -> bool:
    try:
        go_on()
    except GivenUp:
        return True
    return False


def work_of(
    scene: SceneOpened,
    sensors: Sensors | Grid,
    tolerance: float,
    go_on: CancelCheck = always,
    bake: Bake | None = None,
    glazing: Mapping[str, Glazing] | None = None,
) -> Work:
    """Bake a scene, find its work planes unless sensors are given, and trace their rays.

    Args:
        scene: what is measured.
        sensors: where, or how such places are found.
        tolerance: share of radiance by which it may err.
        go_on: called between steps.
        bake: one with rays, where there is one already.
        glazing: of materials by their names, see `Project`; a given bake must have it.

    Raises:
        UserError: no work plane is found, or sensors lie inside bodies.
        GivenUp: by `go_on`.
    """
    bake = bake or baked(scene, tolerance, go_on=go_on, glazing=glazing)
    if isinstance(sensors, Grid):
        bounds = np.asarray(scene.lower_m), np.asarray(scene.upper_m)
        sensors = work_planes(bake, *bounds, sensors.height_m, sensors.step_m)
    glass = glass_of(scene, surfaces_of(scene), glazing)
    operator = operator_of(bake, glass, sensors, RAYS_SHARE * tolerance, bake.threads, go_on)
    return Work(bake, glass, sensors, operator)
