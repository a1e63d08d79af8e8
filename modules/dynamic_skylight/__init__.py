"""DynamicSkyLight: the sun's position and light, and the Hosek-Wilkie sky."""

from dynamic_skylight.hosek_wilkie.sky import HosekWilkieSky
from dynamic_skylight.sun.events import SunEvents, sun_events
from dynamic_skylight.sun.position import SunPosition, sun_position

__all__ = ["HosekWilkieSky", "SunEvents", "SunPosition", "sun_events", "sun_position"]
