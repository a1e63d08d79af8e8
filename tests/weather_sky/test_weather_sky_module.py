"""The module on a real kernel: the contract of every sky, and the hours of a weather file."""

from weather_sky.module import WeatherSky

from vrut_lite.testing.sky_contract import SkyContract


class TestWeatherSky(SkyContract):
    module_type = WeatherSky
