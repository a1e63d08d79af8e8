"""The messages of a light map that belong together, among those that were heard last."""

from typing import ClassVar, NamedTuple

from vrut_lite.frame_part import Heard, Size, latest
from vrut_lite.kernel.messages import Derived
from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.light_map import SLOT, LightMapLaid, SurfaceLightChanged
from vrut_lite.messages.scene import SceneOpened
from vrut_lite.messages.view_light import ViewLightChanged


class FewerRaysLight(Derived, frozen=True, kw_only=True):
    """Light of the same hour and layout as the present one, by fewer rays."""

    slot: ClassVar[str | None] = SLOT

    light: SurfaceLightChanged


class MappedScene(NamedTuple):
    """A scene, the layout of its light map, and the light of an hour in it."""

    scene: SceneOpened
    laid: LightMapLaid
    light: SurfaceLightChanged


def layout_in(heard: Heard) -> LightMapLaid | None:
    """The layout, if it is of the scene: one may arrive after the next scene was opened."""
    scene, laid = latest(heard, SceneOpened), latest(heard, LightMapLaid)
    if scene is None or laid is None or laid.content_key != scene.content_key:
        return None
    return laid if laid.part_shape.shape == scene.geometry.part_mesh.shape else None


def mapped_scene(heard: Heard) -> MappedScene | None:
    """Scene, layout and light that belong together; None while the open sky lights the scene."""
    scene, laid = latest(heard, SceneOpened), layout_in(heard)
    light = latest(heard, SurfaceLightChanged)
    if scene is None or laid is None or light is None or not light.fits(laid):
        return None
    return MappedScene(scene, laid, light)


def light_of_view(heard: Heard, camera: MoveCamera, size_px: Size) -> ViewLightChanged | None:
    """The light of a still from here, where it is known."""
    known = latest(heard, ViewLightChanged)
    is_of_it = known is not None and (known.camera, known.size_px) == (camera, size_px)
    return known if is_of_it else None


def heard_after(heard: Heard, message: Derived) -> Heard:
    """The messages to keep after one that arrives.

    New light of the map removes that of a view, which belongs to other light.
    """
    before = heard.get(type(message))
    if message is before:
        return heard
    after = {**heard, type(message): message}
    if isinstance(message, ViewLightChanged):
        laid = layout_in(heard)
        return after if laid is not None and laid.layout_key == message.layout_key else heard
    after.pop(ViewLightChanged, None)
    if isinstance(message, SurfaceLightChanged):
        after.pop(FewerRaysLight, None)
        if isinstance(before, SurfaceLightChanged) and _is_refined(before, message):
            after[FewerRaysLight] = FewerRaysLight(light=before)
    return after


def _is_refined(before: SurfaceLightChanged, now: SurfaceLightChanged) -> bool:
    """Whether light is of the same hour and layout as that before, by more rays."""
    same_hour = now.sky_level is not None and now.sky_level == before.sky_level
    return same_hour and now.layout_key == before.layout_key and now.rays > before.rays
