"""What tests/integrations/test_blender_addon.py has Blender do: run by a Python that has bpy.

    python in_blender.py ADDON.zip VRUT_LITE FOLDER

Prints one line of JSON.
"""

import json
import math
import shutil
import sys
from pathlib import Path

import bpy

ADDON = "bl_ext.user_default.vrut_lite_daylight"
REFLECTANCE = 0.5


def plane_irradiance(path):
    """The irradiance of a level plane, by Cycles, in linear sRGB."""
    scene = bpy.context.scene
    for thing in [o for o in bpy.data.objects if o.type != "LIGHT"]:
        bpy.data.objects.remove(thing)
    bpy.ops.mesh.primitive_plane_add(size=2)
    material = bpy.data.materials.new("grey")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*3 * [REFLECTANCE], 1.0)
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(diffuse.outputs[0], output.inputs[0])
    bpy.context.object.data.materials.append(material)
    camera = bpy.data.objects.new("above", bpy.data.cameras.new("above"))
    scene.collection.objects.link(camera)
    camera.location, camera.data.type, camera.data.ortho_scale = (0.0, 0.0, 5.0), "ORTHO", 0.5
    scene.camera, scene.render.engine = camera, "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 64, False
    scene.render.resolution_x = scene.render.resolution_y = 16
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    pixels = bpy.data.images.load(path).pixels[:]
    mean = [sum(pixels[k::4]) / (len(pixels) / 4) for k in range(3)]
    return [value * math.pi / REFLECTANCE for value in mean]


def daylight_map(scene=None):
    """The panorama that lights a scene."""
    return (scene or bpy.context.scene).world.node_tree.nodes["vrut_lite map"].image


def is_there(scene=None):
    """A panorama's path in the blend file, and whether the file is there."""
    path = daylight_map(scene).filepath
    return [path, Path(bpy.path.abspath(path)).is_file()]


def lights():
    """What lights the scene: the map's file and source, and the lamp's numbers."""
    lamp = bpy.data.objects["vrut_lite sun"]
    picture = daylight_map()
    return [
        Path(picture.filepath).name,
        picture.source,
        *(round(v, 5) for v in (*lamp.rotation_euler, lamp.data.energy, *lamp.data.color)),
    ]


def wanted():
    """What the facts beside the map say that a level plane gets."""
    facts = json.loads(Path(bpy.path.abspath(daylight_map().filepath) + ".json").read_text())
    pairs = zip(facts["skyHorizontalIrradianceRgb"], facts["sunIrradianceRgb"], strict=True)
    return [sky + sun * facts["sunDirection"][1] for sky, sun in pairs]


def compared(name):
    """What a level plane gets in Cycles, and by the facts."""
    return [plane_irradiance(str(Path(folder) / f"{name}.exr")), wanted()]


archive, program, folder = sys.argv[1:]
bpy.ops.wm.read_factory_settings()
bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default")
bpy.context.preferences.addons[ADDON].preferences.program = program
bpy.data.objects.remove(bpy.data.objects["Light"])
blend_path = str(Path(folder) / "scene.blend")
scene, told = bpy.context.scene, {}
scene.vrut_lite.rows = 256
scene.vrut_lite.hour = 15.0
bpy.ops.wm.save_as_mainfile(filepath=blend_path)
told["saved"] = is_there()
told["light"] = {"day": compared("plane")}
told["at 15"] = lights()
scene.vrut_lite.genus = "St"
told["light"]["stratus"] = compared("stratus")
scene.vrut_lite.genus = "none"
scene.vrut_lite.day, scene.vrut_lite.hour = 27, 23.5
told["light"]["moon"] = compared("moon")
scene.vrut_lite.stars = True
told["light"]["moon in the map"] = compared("stars")
scene.vrut_lite.stars = False
scene.vrut_lite.day, scene.vrut_lite.hour = 21, 15.0
assert lights() == told["at 15"]
bpy.ops.ed.undo_push(message="at 15")
scene.vrut_lite.live = False
scene.vrut_lite.hour = 18.0
bpy.ops.vrut_lite.update()
told["at 18"] = lights()
bpy.ops.ed.undo_push(message="at 18")
bpy.ops.ed.undo()
told["undone"] = lights()
bpy.ops.ed.redo()
scene = bpy.context.scene
scene.vrut_lite.latitude = 50.0
scene.vrut_lite.sky = "bruneton_sky"
bpy.context.preferences.addons[ADDON].preferences.program = "no-such-program"
try:
    bpy.ops.vrut_lite.update()
except RuntimeError as error:
    told["refused"] = str(error)
bpy.context.preferences.addons[ADDON].preferences.program = program
scene.frame_start, scene.frame_end = 1, 3
scene.vrut_lite.from_hour, scene.vrut_lite.to_hour = 11.0, 15.0
bpy.ops.vrut_lite.key_day()
told["day"] = []
for frame in (1, 2, 3):
    scene.frame_set(frame)
    told["day"].append(lights())
bpy.ops.wm.save_mainfile()
bpy.ops.wm.open_mainfile(filepath=blend_path)
bpy.context.scene.frame_set(3)
told["reopened"] = [lights(), round(bpy.context.scene.vrut_lite.latitude, 3)]
scene = bpy.context.scene
scene.vrut_lite.rows = 64
scene.vrut_lite.live = True
scene.vrut_lite.hour = 18.0
told["one hour after a day"] = []
for frame in (1, 2, 3):
    scene.frame_set(frame)
    told["one hour after a day"].append(lights())
other = bpy.data.scenes.new("Other")
other.vrut_lite.rows = 64
other.vrut_lite.hour = 8.0
told["other scene"] = [lights(), is_there(scene), is_there(other)]
bpy.ops.wm.save_mainfile()
moved = Path(folder) / "moved"
moved.mkdir()
for name in ("scene.blend", "scene.skies"):
    shutil.move(Path(folder) / name, moved / name)
bpy.ops.wm.open_mainfile(filepath=str(moved / "scene.blend"))
told["moved"] = [is_there(scene) for scene in bpy.data.scenes]
(Path(folder) / "else").mkdir()
bpy.ops.wm.save_as_mainfile(filepath=str(Path(folder) / "else" / "copy.blend"))
told["saved elsewhere"] = [is_there(scene) for scene in bpy.data.scenes]
# A file lies where the folder for skies would be.
blocked = Path(folder) / "else" / "blocked.skies"
blocked.write_text("")
scene = bpy.data.scenes["Scene"]
bpy.ops.wm.save_as_mainfile(filepath=str(blocked.with_suffix(".blend")))
told["saved without a folder"] = scene.vrut_lite.said
scene.vrut_lite.hour = 9.0
told["no folder"] = scene.vrut_lite.said
blocked.unlink()
bpy.data.worlds.remove(scene.world)
scene.vrut_lite.hour = 10.0
told["without a world"] = is_there(scene)
told["enabled"] = lights()
bpy.ops.preferences.addon_disable(module=ADDON)
told["disabled"] = lights()
print("TOLD " + json.dumps(told))
