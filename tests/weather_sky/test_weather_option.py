"""--weather in commands and project files: the place, the module that follows, what is told."""

import msgspec
import pytest
from command_output import shared_options
from weather_sky.module import WeatherSky

from vrut_lite.errors import UserError
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import ChooseSlot
from vrut_lite.messages.weather import SetWeather
from vrut_lite.project import Project, load_project, save_project, weather_inputs
from vrut_lite.testing.sky_on_bus import AnotherSky
from vrut_lite.weather.weather_file import read_weather


def test_the_place_is_the_files(year_file):
    """Its latitude, longitude and altitude; nothing is said where nothing lacks."""
    project, said = shared_options("--weather", str(year_file))
    assert (project.weather, project.place) == (str(year_file), "50.1,14.4,200")
    assert said == ""


def test_two_places_are_refused(year_file):
    """One of them would be ignored."""
    with pytest.raises(UserError, match="--weather and --place both name a place"):
        shared_options("--weather", str(year_file), "--place", "10,20")


def test_what_a_file_lacks_is_told(year_text, tmp_path):
    """On standard error, a line each."""
    lines = year_text.splitlines()
    cells = lines[20].split(",")
    cells[14] = "9999"
    lines[20] = ",".join(cells)
    (tmp_path / "gap.epw").write_text("\n".join(lines))
    _, said = shared_options("--weather", str(tmp_path / "gap.epw"))
    assert "gap.epw: 1 hour lacks direct normal irradiance" in said


def test_a_project_file_keeps_the_weather(year_file, tmp_path):
    """By a path from the project's folder; without a place of its own it has the file's."""
    path = tmp_path / "p.toml"
    save_project(path, Project(scene="a.glb", weather=str(year_file)))
    read = load_project(path)
    assert read_weather(read.weather) == read_weather(read.weather)
    assert read.place == "50.0755,14.4378,200"
    text = path.read_text()
    assert 'weather = "' in text
    assert str(tmp_path) not in text
    path.write_text(text.replace('place = "50.0755,14.4378,200"\n', ""))
    assert load_project(path).place == "50.1,14.4,200"


def test_the_module_that_hears_the_weather_follows_it(year_file):
    """It gets both slots, unless others are chosen; without one the sentence says so."""
    weather = read_weather(year_file)
    kernel = Kernel()
    with pytest.raises(UserError, match="no installed module follows the weather"):
        weather_inputs(weather, kernel, {})
    kernel.add_module(AnotherSky)
    kernel.add_module(WeatherSky)
    both = [ChooseSlot(slot=slot, module="weather_sky") for slot in ("sun", "sky")]
    assert weather_inputs(weather, kernel, {}) == [weather, *both]
    assert weather_inputs(weather, kernel, {"sky": "another_sky"}) == [weather]
    kernel.close()


def test_a_year_is_checked(year_file):
    """A message of a stranger: every column of one year, finite, of its range."""
    weather = read_weather(year_file)
    weather.check()
    for name, values, said in (
        ("direct_normal_w_m2", (1.0,) * 100, "have 8760 or 8784 hours"),
        ("dew_point_c", (float("nan"),) * 8760, "hold finite numbers"),
        ("cloud_cover", (2.0,) * 8760, "hold numbers from 0 to 1"),
        ("latitude_deg", 91.0, "-90 to 90"),
    ):
        with pytest.raises(UserError, match=said):
            msgspec.structs.replace(weather, **{name: values}).check()
    assert isinstance(weather, SetWeather)
