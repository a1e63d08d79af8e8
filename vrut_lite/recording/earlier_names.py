"""Messages of earlier versions in today's words, so that their journals still replay."""

import re
from typing import Any

Plain = dict[str, Any]
# A field that an earlier version did not record: it equals any value.
UNKNOWN = {"$unknown": True}

_RENAMED = {"SunLightChanged": "KeyLightChanged", "SceneLoaded": "SceneOpened"}
# Fields of SceneOpened that journals of earlier versions lack.
_LATER_OF_SCENES = (
    "geometry", "materials", "ground", "camera", "lamps", "notices", "opened", "cameras",
    "animation_s", "variants", "points_and_lines", "border_rgb",
)  # fmt: skip
# Fields that earlier messages lack, by today's type names, with their values at that time.
_ADDED: dict[str, Plain] = {
    "AmbientChanged": {"lamps_rgb": [0.0, 0.0, 0.0]},
    "KeyLightChanged": {"body": "sun", "haze": UNKNOWN},
    "NightLightChanged": {"lamps_rgb": UNKNOWN},
    "SceneOpened": dict.fromkeys(_LATER_OF_SCENES, UNKNOWN),
}


# Fields that earlier atmospheres lack: a tabulated phase function, aerosol aloft and in the
# stratosphere, layers of molecules.
_LATER_OF_AIR: Plain = {
    "mie_table": None,
    "aloft_scattering": UNKNOWN,
    "aloft_extinction": UNKNOWN,
    "aloft_scale_height_m": 8000.0,
    "aloft_table": None,
    "fog_table": None,
    "stratosphere_scattering": UNKNOWN,
    "stratosphere_extinction": UNKNOWN,
    "stratosphere_peak_m": UNKNOWN,
    "stratosphere_half_width_m": 6000.0,
    "stratosphere_table": UNKNOWN,
    "rayleigh_above_m": [0.0],
    "rayleigh_above_scale_height_m": [8000.0],
}
# Settings that earlier versions lacked, by one that the same modules had already, and what skies
# were without them: their defaults are others today.
_LATER_SETTINGS: dict[str, Plain] = {
    "mie_g": {"aerosol": "one-lobe"},
    "sun_colour": {"sky_level": "published"},
}
_HAZE_REFUSED = re.compile(r"^(turbidity of \w+ must be between 1 and 10), not ")


def settings_in_todays_words(settings: Plain) -> Plain:
    """A module's recorded settings, with those that it lacked and what they would have been."""
    added = (later for known, later in _LATER_SETTINGS.items() if known in settings)
    return {name: value for later in added for name, value in later.items()} | settings


def in_todays_words(type_name: str, message: Plain) -> tuple[str, Plain]:
    """Type name and plain message as today's version would have recorded them."""
    name = _RENAMED.get(type_name, type_name)
    added = {field: value for field, value in _ADDED.get(name, {}).items() if field not in message}
    if name == "Demand":
        if message.get("message") in _RENAMED:
            added["message"] = _RENAMED[message["message"]]
        # A size of 1 meant that the sky chooses; no consumer shows a sky of one texel.
        if message.get("message") == "BackgroundChanged" and message.get("size") == 1:
            added["size"] = None
    # Aerosol had one type.
    if name == "SetHaze":
        added |= {"aerosol": "one-lobe"} if "aerosol" not in message else {}
        added |= {"own": None} if "own" not in message else {}
    # The look of nights was a tone map.
    if name == "SetExposure" and message.get("tone_map") == "eye":
        added["tone_map"] = "agx"
    # The handler that reported a failed GPU, by its name in a Fault.
    if name == "Fault" and message.get("where") == "cube_done":
        added["where"] = "job_done"
    # A sky's own haze had to be a number.
    if name == "Fault" and "error" in message:
        added["error"] = _HAZE_REFUSED.sub(r"\1, or none, not ", str(message["error"]))
    # One body lit the air, and the aerosol's phase function was three numbers.
    volume = message.get("volume")
    if name == "AirChanged" and volume and "second" not in volume:
        phase = volume["aerosol_phase"]
        phase = UNKNOWN if isinstance(phase, list) else phase
        added["volume"] = {**volume, "aerosol_phase": phase, "second": None}
    # There was one layer, of droplets; its form was the same for all.
    if name == "CloudsChanged" and "layer" in message:
        layer = message["layer"]
        of_today = [{**layer, "particles": "droplets", "form": UNKNOWN}] if layer else []
        message = {field: told for field, told in message.items() if field != "layer"}
        added["layers"] = of_today
    # Light in clouds came from two lobes.
    if name == "CloudsChanged":
        layers = added.get("layers") or message.get("layers") or []
        added["layers"] = [
            {field: told for field, told in layer.items() if field != "phase"} for layer in layers
        ]
    value = message.get("value")
    if (
        name == "JobResult"
        and isinstance(value, dict)
        and isinstance(value.get("atmosphere"), dict)
    ):
        added["value"] = {**value, "atmosphere": {**_LATER_OF_AIR, **value["atmosphere"]}}
    return (name, {**message, **added}) if added else (name, message)
