"""The panel Daylight in the world's properties: place, hour and air; a day as an animation."""

import tempfile
import zlib
from datetime import date
from pathlib import Path
from typing import ClassVar

import bpy

from .blend_world import clear_sun_keys, show_hour, show_sequence, show_sun
from .child import Child, NoDaylight
from .sky_file import Hour, sun_lamp

CHILD = Child()
# Genera of the module clouds by its settings.
_CLOUDS = {
    "genus": ("Low clouds", {"Cu": "Cumulus", "Sc": "Stratocumulus", "St": "Stratus",
                             "Ns": "Nimbostratus", "Cb": "Cumulonimbus"}),
    "middle_genus": ("Middle clouds", {"Ac": "Altocumulus", "As": "Altostratus"}),
    "high_genus": ("High clouds", {"Ci": "Cirrus", "Cs": "Cirrostratus"}),
}  # fmt: skip
# While a slider moves, a sky is asked for as often as this.
_PAUSE_S = 0.15
# Names of the scenes that wait for one.
_WAITING = set()


class Preferences(bpy.types.AddonPreferences):
    """Where vrut_lite is."""

    bl_idname = __package__
    program: bpy.props.StringProperty(
        name="vrut-lite",
        description="The program of an installed vrut_lite, as .venv/bin/vrut-lite",
        subtype="FILE_PATH",
        default="vrut-lite",
    )

    def draw(self, context):
        """One field."""
        self.layout.prop(self, "program")


def _changed(self, context):
    if not self.live:
        return
    # The scene that changed need not be the one in view.
    if bpy.app.background:
        update(self.id_data)
        return
    _WAITING.add(self.id_data.name)
    if not bpy.app.timers.is_registered(_update_later):
        bpy.app.timers.register(_update_later, first_interval=_PAUSE_S)


def _update_later():
    while _WAITING:
        scene = bpy.data.scenes.get(_WAITING.pop())
        if scene is not None:
            update(scene)


def _number(name, description, default, least, most, **more):
    return bpy.props.FloatProperty(
        name=name, description=description, default=default, min=least, max=most, update=_changed,
        **more,
    )  # fmt: skip


def _whole(name, description, default, least, most):
    return bpy.props.IntProperty(
        name=name, description=description, default=default, min=least, max=most, update=_changed
    )


def _genus(setting):
    title, genera = _CLOUDS[setting]
    items = [("none", "None", "Without them"), *((key, name, key) for key, name in genera.items())]
    return bpy.props.EnumProperty(name=title, items=items, update=_changed)


class Daylight(bpy.types.PropertyGroup):
    """What the panel holds; it is saved with the scene."""

    latitude: _number("Latitude", "Degrees north", 50.0755, -90.0, 90.0)
    longitude: _number("Longitude", "Degrees east", 14.4378, -180.0, 180.0)
    altitude: _number("Altitude", "Metres above the sea", 0.0, -430.0, 9000.0)
    year: _whole("Year", "Of the date", 2026, 1600, 2600)
    month: _whole("Month", "Of the date", 6, 1, 12)
    day: _whole("Day", "Of the month; in shorter months the last", 21, 1, 31)
    hour: _number("Hour", "Local time at the place", 12.0, 0.0, 24.0)
    sky: bpy.props.EnumProperty(
        name="Sky",
        items=[
            ("dynamic_skylight", "Hosek-Wilkie", "Fast; fitted to clear skies"),
            ("bruneton_sky", "Bruneton", "Solved scattering, exact in twilight too"),
        ],
        update=_changed,
    )
    haze: _number("Haze", "Optical depth of aerosol at 550 nm", 0.2, 0.0, 0.9)
    albedo: _number("Ground", "Part of the light that the ground sends back", 0.2, 0.0, 1.0)
    rows: _whole("Rows", "Height of the sky's picture in pixels", 512, 64, 4096)
    genus: _genus("genus")
    middle_genus: _genus("middle_genus")
    high_genus: _genus("high_genus")
    stars: bpy.props.BoolProperty(
        name="Stars", description="By night stars, planets and the moon's disc", update=_changed
    )
    live: bpy.props.BoolProperty(name="Live", description="Follow every change", default=True)
    from_hour: bpy.props.FloatProperty(name="From", default=5.0, min=0.0, max=24.0)
    to_hour: bpy.props.FloatProperty(name="To", default=21.0, min=0.0, max=24.0)
    said: bpy.props.StringProperty()
    failed: bpy.props.BoolProperty()


def update(scene):
    """Show the sky of the panel's hour, or why there is none."""
    daylight = scene.vrut_lite
    try:
        path = _folder() / f"{_file_name(scene)}.exr"
        CHILD.ask(_program(), _hour(daylight, daylight.hour).words(path))
    except NoDaylight as error:
        daylight.said, daylight.failed = str(error), True
        return False
    sun = sun_lamp(path, daylight.stars)
    show_hour(scene, path, sun)
    daylight.said, daylight.failed = sun.caption, False
    return True


def _hour(daylight, hour):
    for last in range(daylight.day, 27, -1):
        try:
            day = date(daylight.year, daylight.month, last)
            break
        except ValueError:
            continue
    else:
        day = date(daylight.year, daylight.month, daylight.day)
    genera = {setting: getattr(daylight, setting) for setting in _CLOUDS}
    return Hour(
        latitude_deg=daylight.latitude, longitude_deg=daylight.longitude,
        altitude_m=daylight.altitude, date=day.isoformat(), hour=hour, sky=daylight.sky,
        haze=daylight.haze, albedo=daylight.albedo, rows=daylight.rows,
        clouds={setting: genus for setting, genus in genera.items() if genus != "none"},
        stars=daylight.stars,
    )  # fmt: skip


def _program():
    addon = bpy.context.preferences.addons.get(__package__)
    return bpy.path.abspath(addon.preferences.program) if addon else "vrut-lite"


def _folder():
    """Beside the blend file; before it is saved, for this run of Blender only.

    NoDaylight where it cannot be made.
    """
    if bpy.data.filepath:
        folder = Path(bpy.data.filepath).with_suffix(".skies")
    else:
        folder = Path(bpy.app.tempdir or tempfile.gettempdir()) / "vrut_lite"
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise NoDaylight(
            f"cannot make the folder {folder} for skies ({error.strerror}): save the file elsewhere"
        ) from error
    return folder


def _file_name(scene):
    """A name of files that no other scene has: Blender cleans some names to the same."""
    name = bpy.path.clean_name(scene.name)
    return name if name == scene.name else f"{name}_{zlib.crc32(scene.name.encode()):08x}"


class VRUT_LITE_OT_update(bpy.types.Operator):
    """Compute the sky and the sun of this hour"""

    bl_idname = "vrut_lite.update"
    bl_label = "Show this hour"
    bl_options: ClassVar = {"REGISTER", "UNDO"}

    def execute(self, context):
        """Show the hour; the reason is reported if that fails."""
        if update(context.scene):
            return {"FINISHED"}
        self.report({"ERROR"}, context.scene.vrut_lite.said)
        return {"CANCELLED"}


class VRUT_LITE_OT_key_day(bpy.types.Operator):
    """Spread the hours over the scene's frames: a map for each frame, keys for the sun"""

    bl_idname = "vrut_lite.key_day"
    bl_label = "Key a day"
    bl_options: ClassVar = {"REGISTER", "UNDO"}

    def execute(self, context):
        """Write a sky for each frame, then show them as a sequence."""
        scene, daylight = context.scene, context.scene.vrut_lite
        frames = range(scene.frame_start, scene.frame_end + 1)
        steps = max(len(frames) - 1, 1)
        try:
            folder, name = _folder(), _file_name(scene)
            paths = [folder / f"{name}_{frame:04d}.exr" for frame in frames]
            for k, path in enumerate(paths):
                hour = daylight.from_hour + (daylight.to_hour - daylight.from_hour) * k / steps
                CHILD.ask(_program(), _hour(daylight, hour).words(path))
        except NoDaylight as error:
            daylight.said, daylight.failed = str(error), True
            self.report({"ERROR"}, daylight.said)
            return {"CANCELLED"}
        clear_sun_keys(scene)
        for frame, path in zip(frames, paths, strict=True):
            show_sun(scene, sun_lamp(path, daylight.stars), frame)
        show_sequence(scene, paths[0], frames[0], len(frames))
        daylight.said, daylight.failed = f"{len(frames)} skies, one a frame", False
        return {"FINISHED"}


class VRUT_LITE_PT_daylight(bpy.types.Panel):
    """Place, date, hour and air."""

    bl_label = "Daylight"
    bl_idname = "VRUT_LITE_PT_daylight"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "world"

    def draw(self, context):
        """The panel."""
        daylight, layout = context.scene.vrut_lite, self.layout
        layout.use_property_split = True
        layout.prop(daylight, "hour", slider=True)
        row = layout.column(align=True)
        for name in ("day", "month", "year"):
            row.prop(daylight, name)
        row = layout.column(align=True)
        for name in ("latitude", "longitude", "altitude"):
            row.prop(daylight, name)
        # What the program has not is not offered.
        clouds = tuple(_CLOUDS) if "clouds" in CHILD.modules else ()
        night = ("stars",) if "night_sky" in CHILD.modules else ()
        for name in ("sky", "haze", "albedo", *clouds, *night, "rows", "live"):
            layout.prop(daylight, name)
        layout.operator("vrut_lite.update")
        if daylight.said:
            layout.label(text=daylight.said, icon="ERROR" if daylight.failed else "LIGHT_SUN")
        row = layout.column(align=True)
        row.prop(daylight, "from_hour")
        row.prop(daylight, "to_hour")
        layout.operator("vrut_lite.key_day")


CLASSES = (
    Preferences,
    Daylight,
    VRUT_LITE_OT_update,
    VRUT_LITE_OT_key_day,
    VRUT_LITE_PT_daylight,
)
