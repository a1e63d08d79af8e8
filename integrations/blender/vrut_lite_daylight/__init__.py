"""The sky and the sun of a place and an hour in Blender, computed by vrut_lite."""

import bpy

from . import panel


def register():
    """Add the panel (Blender calls this)."""
    for kind in panel.CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.vrut_lite = bpy.props.PointerProperty(type=panel.Daylight)


def unregister():
    """Take the panel away and end the child; sky and sun stay in the file."""
    panel.CHILD.close()
    del bpy.types.Scene.vrut_lite
    for kind in reversed(panel.CLASSES):
        bpy.utils.unregister_class(kind)
