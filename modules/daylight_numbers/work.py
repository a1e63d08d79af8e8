"""A scene made ready for daylight numbers: its transport, glass, sensors and their matrix."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from light_transport.public import (
    CancelCheck,
    SceneTransport,
    TransportSizes,
    always,
    first_rays,
    quality_for,
    surfaces_of,
)

from daylight_numbers.glazing.glass import Glass, glass_of, with_glazing
from daylight_numbers.glazing.pane_materials import PaneMaterials, pane_materials
from daylight_numbers.matrix.measured_panes import measured_panes
from daylight_numbers.matrix.operator import Operator, operator_of
from daylight_numbers.matrix.pane_bounces import PaneBounces, pane_bounces
from daylight_numbers.matrix.sensors import SensorGrid, Sensors
from daylight_numbers.matrix.work_planes import work_planes
from vrut_lite.errors import UserError
from vrut_lite.messages.glazing import Glazing, GlazingFile
from vrut_lite.messages.scene import SceneOpened

# Share of the tolerance of radiance for rays of sensors: 1 % at its default.
RAYS_SHARE = 0.1


@dataclass(frozen=True, eq=False)
class DaylightWork:
    """All that an hour or a year is computed from."""

    transport: SceneTransport
    glass: Glass
    sensors: Sensors
    operator: Operator


def traced_transport(
    scene: SceneOpened,
    tolerance: float,
    share_of_texels: float = 1.0,
    go_on: CancelCheck = always,
    glazing: Mapping[str, Glazing] | None = None,
    panes: PaneMaterials | None = None,
) -> SceneTransport:
    """A scene's transport by all rays of a tolerance; rays are kept on disk.

    Panes of measured glazing are opaque in it.

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
    if panes is not None:
        surfaces = panes.opaque(surfaces)
    texels = int(quality.texels * share_of_texels)
    sizes = TransportSizes(None, texels, quality.patch_texels, quality.bounces_left)
    found = SceneTransport.of_scene(scene, surfaces, sizes, go_on=go_on)
    # Patches follow from the first round, and so do kept rays: it is the module's own.
    for rays in (first_rays(found.rows), quality.rays):
        found.add_cached_rays(rays - found.rays, go_on)
    return found


def work_of(
    scene: SceneOpened,
    sensors: Sensors | SensorGrid,
    tolerance: float,
    go_on: CancelCheck = always,
    transport: SceneTransport | None = None,
    glazing: Mapping[str, Glazing] | None = None,
    bsdf: Mapping[str, GlazingFile] | None = None,
) -> DaylightWork:
    """Bake a scene, find its work planes unless sensors are given, and trace their rays.

    Args:
        scene: with its surfaces.
        sensors: where, or how such places are found.
        tolerance: share of radiance by which it may err.
        go_on: called between steps.
        transport: one with rays, where there is one already.
        glazing: of materials by their names, see `Project`; a given transport must have it.
        bsdf: measured glazing of materials by their names; likewise.

    Raises:
        UserError: no work plane is found, sensors lie inside bodies, or measured glazing cannot be
            read or used.
    """
    surfaces = surfaces_of(scene)
    panes = pane_materials(scene, surfaces, bsdf or {})
    transport = transport or traced_transport(
        scene, tolerance, go_on=go_on, glazing=glazing, panes=panes
    )
    if isinstance(sensors, SensorGrid):
        bounds = np.asarray(scene.lower_m), np.asarray(scene.upper_m)
        sensors = work_planes(transport, *bounds, sensors.height_m, sensors.step_m)
    glass = glass_of(scene, surfaces, glazing)
    bounces = None
    if panes is not None:
        glass = panes.without(glass)
        bounces = bounces_of(transport, glass, panes, go_on)
    operator = operator_of(
        transport, glass, sensors, RAYS_SHARE * tolerance, transport.threads, go_on, bounces
    )
    return DaylightWork(transport, glass, sensors, operator)


def bounces_of(
    transport: SceneTransport, glass: Glass, panes: PaneMaterials, go_on: CancelCheck = always
) -> PaneBounces:
    """The light of measured panes in a scene where they are opaque.

    Raises:
        UserError: a pane does not stand between outdoors and indoors.
        GivenUp: by `go_on`.
    """
    return pane_bounces(transport, measured_panes(transport, glass, panes, go_on), go_on)
