"""The sky and the sun of a place and an hour in Blender, computed by vrut_lite."""

import bpy

from . import blend_world, panel


@bpy.app.handlers.persistent
def _before_save(path):
    # Without a path Blender saves its start-up file.
    if not path:
        return
    try:
        blend_world.take_along(path)
    except OSError as error:
        why = f"the skies could not be saved beside the file ({error.strerror}): save it elsewhere"
        for scene in bpy.data.scenes:
            scene.vrut_lite.said, scene.vrut_lite.failed = why, True


def register():
    """Add the panel (Blender calls this)."""
    for kind in panel.CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.vrut_lite = bpy.props.PointerProperty(type=panel.Daylight)
    bpy.app.handlers.save_pre.append(_before_save)


def unregister():
    """Take the panel away and end the child; sky and sun stay in the file."""
    bpy.app.handlers.save_pre.remove(_before_save)
    panel.CHILD.close()
    del bpy.types.Scene.vrut_lite
    for kind in reversed(panel.CLASSES):
        bpy.utils.unregister_class(kind)
