"""Puts a sky into a scene of Blender: the world's texture and a sun lamp.

Each scene has a world, a picture and a lamp of its own.
"""

import math
import re
import shutil
from pathlib import Path

import bpy

# What the add-on made is found by these names, to which Blender adds numbers, so that a change
# replaces it.
WORLD, SUN, TEXTURE, BACKGROUND = "vrut_lite sky", "vrut_lite sun", "vrut_lite map", "vrut_lite"


def show_hour(scene, path, sun):
    """Let a panorama (radiance in W m^-2 sr^-1, strength 1) and the sun light every frame."""
    _show_image(scene, path)
    clear_sun_keys(scene)
    show_sun(scene, sun)


def show_sequence(scene, first_path, first_frame, count):
    """Let panoramas light the scene, one a frame."""
    texture = _show_image(scene, first_path)
    texture.image.source = "SEQUENCE"
    user = texture.image_user
    user.frame_start, user.frame_duration, user.frame_offset = first_frame, count, 0
    user.use_auto_refresh = True


def show_sun(scene, sun, frame=None):
    """Let the sun shine; with a frame, from there on by keys."""
    lamp = _sun_object(scene)
    lamp.rotation_mode = "XYZ"
    lamp.rotation_euler = _continued(lamp.rotation_euler, sun.rotation)
    lamp.data.energy, lamp.data.color, lamp.data.angle = sun.strength, sun.colour, sun.angle
    if frame is not None:
        lamp.keyframe_insert("rotation_euler", frame=frame)
        for name in ("energy", "color", "angle"):
            lamp.data.keyframe_insert(name, frame=frame)


def clear_sun_keys(scene):
    """Forget the keys of an earlier day."""
    lamp = _sun_object(scene)
    lamp.animation_data_clear()
    lamp.data.animation_data_clear()


def _continued(before, after):
    """The same direction by angles near those before, so that keys do not turn the long way."""
    full = 2.0 * math.pi
    return [new + full * round((old - new) / full) for old, new in zip(before, after, strict=True)]


def take_along(blend_path):
    """Copy the panoramas beside a blend file that is about to be saved, and refer to them there."""
    folder = Path(blend_path).with_suffix(".skies")
    for image in bpy.data.images:
        path = Path(bpy.path.abspath(image.filepath))
        if not image.get("vrut_lite") or path.parent == folder or not path.is_file():
            continue
        folder.mkdir(exist_ok=True)
        for file in _files_of(image, path):
            shutil.copy2(file, folder / file.name)
        # While saving, Blender turns paths relative to the last file into those to the new one.
        known = bpy.data.filepath
        copied = folder / path.name
        image.filepath = bpy.path.relpath(str(copied)) if known else f"//{folder.name}/{path.name}"


def _files_of(image, path):
    """A panorama's files and those of its sequence, with the facts beside them."""
    stem = re.escape(path.stem)
    if image.source == "SEQUENCE":
        stem = re.escape(path.stem.rstrip("0123456789")) + r"\d+"
    name = re.compile(rf"{stem}\.exr(\.json)?")
    return [file for file in path.parent.iterdir() if name.fullmatch(file.name)]


def _show_image(scene, path):
    """The world's texture node, with a picture that no other world shows."""
    texture = _world_nodes(scene)[TEXTURE]
    image = texture.image
    name = bpy.path.relpath(str(path)) if bpy.data.filepath else str(path)
    if image and image.get("vrut_lite") and image.source == "FILE" and image.users == 1:
        image.filepath = name
        image.reload()
    else:
        image = bpy.data.images.load(str(path))
        image.filepath = name
        image["vrut_lite"] = True
        texture.image = image
    image.colorspace_settings.name = "Linear Rec.709"
    return texture


def _is_named(thing, name):
    """Whether a name is ours, or ours with the number of a second one."""
    return thing.name.partition(".")[0] == name


def _world_nodes(scene):
    world = scene.world
    others = [other.world for other in bpy.data.scenes if other != scene]
    if world is None or not _is_named(world, WORLD) or world in others:
        world = scene.world = bpy.data.worlds.new(WORLD)
    if world.node_tree is None:
        world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    if TEXTURE not in nodes:
        nodes.clear()
        texture = nodes.new("ShaderNodeTexEnvironment")
        texture.name = TEXTURE
        background = nodes.new("ShaderNodeBackground")
        background.name = BACKGROUND
        output = nodes.new("ShaderNodeOutputWorld")
        texture.location, output.location = (-300, 0), (220, 0)
        links.new(texture.outputs["Color"], background.inputs["Color"])
        links.new(background.outputs["Background"], output.inputs["Surface"])
    return nodes


def _sun_object(scene):
    lamps = [thing for thing in scene.collection.all_objects if _is_named(thing, SUN)]
    for lamp in lamps:
        if lamp.users_scene == (scene,):
            return lamp
        # A copied scene has the lamp of the other one.
        if lamp.name in scene.collection.objects:
            scene.collection.objects.unlink(lamp)
    lamp = bpy.data.objects.new(SUN, bpy.data.lights.new(SUN, "SUN"))
    scene.collection.objects.link(lamp)
    return lamp
