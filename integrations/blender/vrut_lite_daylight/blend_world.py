"""Puts a sky into a scene of Blender: the world's texture and a sun lamp."""

import math

import bpy

# What the add-on made is found by these names, so that a change replaces it.
WORLD, SUN, TEXTURE, BACKGROUND = "vrut_lite sky", "vrut_lite sun", "vrut_lite map", "vrut_lite"


def show_sky(scene, path):
    """Let a panorama light the scene: radiance in W m^-2 sr^-1, strength 1."""
    image = _image(path)
    nodes = _world_nodes(scene)
    nodes[TEXTURE].image = image


def show_sequence(scene, first_path, first_frame, count):
    """Let panoramas light the scene, one a frame."""
    image = _image(first_path)
    image.source = "SEQUENCE"
    texture = _world_nodes(scene)[TEXTURE]
    texture.image = image
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


def _image(path):
    for image in bpy.data.images:
        if image.get("vrut_lite") and image.source == "FILE":
            image.filepath = str(path)
            image.reload()
            break
    else:
        image = bpy.data.images.load(str(path))
        image["vrut_lite"] = True
    image.colorspace_settings.name = "Linear Rec.709"
    return image


def _world_nodes(scene):
    world = scene.world
    if world is None or world.name != WORLD:
        world = bpy.data.worlds.get(WORLD) or bpy.data.worlds.new(WORLD)
        scene.world = world
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
    lamp = bpy.data.objects.get(SUN)
    if lamp is None:
        lamp = bpy.data.objects.new(SUN, bpy.data.lights.new(SUN, "SUN"))
    if lamp.name not in scene.collection.all_objects:
        scene.collection.objects.link(lamp)
    return lamp
