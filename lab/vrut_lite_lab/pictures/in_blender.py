"""Renders a glTF scene in Cycles under the add-on's light; run by a Python that has bpy.

    python in_blender.py ADDON.zip VRUT_LITE SCENE FOLDER HOUR...

The scene's own camera looks; FOLDER gets cycles_HOUR.exr for each hour.
"""

import sys
from pathlib import Path

import bpy

ADDON = "bl_ext.user_default.vrut_lite_daylight"
archive, program, scene_path, folder, *hours = sys.argv[1:]

bpy.ops.wm.read_factory_settings()
bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default")
bpy.context.preferences.addons[ADDON].preferences.program = program
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
bpy.ops.import_scene.gltf(filepath=scene_path)
scene = bpy.context.scene
scene.camera = next(thing for thing in bpy.data.objects if thing.type == "CAMERA")
scene.render.engine = "CYCLES"
scene.cycles.samples, scene.cycles.use_denoising = 64, True
scene.render.resolution_x, scene.render.resolution_y = 480, 300
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
for hour in hours:
    scene.vrut_lite.hour = float(hour)
    scene.render.filepath = str(Path(folder) / f"cycles_{hour}.exr")
    bpy.ops.render.render(write_still=True)
