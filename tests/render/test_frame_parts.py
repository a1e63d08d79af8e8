"""Frame parts draw over the sky alone, and a fault of one leaves the picture whole."""

from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest
from box_stage import uniform_sky
from click.testing import CliRunner
from scene_stage import light, look
from stateful_backend import StatefulBackend, opened

from vrut_lite import installed_parts
from vrut_lite.commands.modules import modules
from vrut_lite.errors import ModuleFailed
from vrut_lite.frame_part import FramePart
from vrut_lite.host import Host
from vrut_lite.kernel.messages import Derived, Fault, SetSetting
from vrut_lite.messages.clouds import CloudsChanged
from vrut_lite.project import Project, daylight_inputs
from vrut_lite.render.part_slots import part_blocks, part_units
from vrut_lite.render.pyrender_backend import PyrenderBackend
from vrut_lite.render.shader_files import shader_source

SIZE = 32, 24
SHADER = """#version 430 core
uniform vec3 glow;
in vec3 ray;
out vec4 frag_radiance;
void main() { frag_radiance = vec4(ray.y > 0.0 ? glow : vec3(0.0), 0.0); }
"""


class GlowShown(Derived, frozen=True, kw_only=True):
    """Radiance (3,) that a test's part adds above the horizon."""

    glow: tuple[float, float, float]


class Glow(FramePart):
    """Adds it."""

    hears = (GlowShown,)

    def show(self, heard):
        """Take the radiance."""
        if not hasattr(self, "screen"):
            self.screen = self.gl.screen(self.shader)
        self.glow = heard[GlowShown].glow

    def draw_over_sky(self, size_px, view):
        """Add it everywhere."""
        self.screen.set("glow", self.glow)
        self.screen.draw(view)
        self.gl.counters.did("glow")


class Broken(FramePart):
    """Raises when it draws."""

    hears = (GlowShown,)

    def draw_over_sky(self, size_px, view):
        """Fail."""
        raise ZeroDivisionError("no glow")


CACHES = (installed_parts.find_parts, part_blocks, part_units, shader_source)


@pytest.fixture
def install(monkeypatch):
    """Installs these parts, by the names of their entry points, and no others."""

    def put(**parts):
        points = [
            EntryPoint(name, f"{__name__}:{part.__name__}", installed_parts.GROUP)
            for name, part in parts.items()
        ]
        monkeypatch.setattr(installed_parts, "usable_points", lambda group: points)
        for cached in CACHES:
            cached.cache_clear()

    yield put
    for cached in CACHES:
        cached.cache_clear()


@pytest.fixture
def glowing(gl_owner, box_file, tmp_path, install):
    """A backend with both parts installed, and the box under a black sky."""
    Glow.shader = Path(tmp_path / "glow.frag")
    Glow.shader.write_text(SHADER)
    install(Broken=Broken, Glow=Glow)
    backend = PyrenderBackend(gl_owner)
    stage = StatefulBackend(backend, size_px=SIZE, scene=opened(box_file))
    light(stage, uniform_sky(0.0), sun_irradiance=(0.0,) * 3)
    yield stage
    backend.close()


@pytest.mark.gl
@pytest.mark.parametrize("still", [True, False])
def test_a_part_adds_to_the_sky_alone(glowing, still):
    """Above the horizon its radiance, below it and on the box nothing; in motion as at rest."""
    glowing.hear(GlowShown(glow=(3.0, 2.0, 1.0)))
    up = look(glowing, (0.0, 1.0, 9.0), (0.0, 9.0, 0.0), still=still).radiance
    np.testing.assert_allclose(up, np.broadcast_to([3.0, 2.0, 1.0], up.shape), rtol=1e-6)
    box = look(glowing, (0.0, 1.0, 2.0), (0.0, 1.0, 0.0), still=still).radiance
    assert box.max() == 0.0


@pytest.mark.gl
def test_parts_stay_whole_while_the_camera_turns(glowing):
    """Moving pictures reuse the sky of the last one at another depth; each pixel keeps the glow."""
    glowing.hear(GlowShown(glow=(3.0, 2.0, 1.0)))
    for turn in range(4):
        target = (0.02 * turn, 9.0, 0.0)
        seen = look(glowing, (0.0, 1.0, 9.0), target, still=False).radiance
        np.testing.assert_allclose(seen, np.broadcast_to([3.0, 2.0, 1.0], seen.shape), rtol=1e-6)


@pytest.mark.gl
def test_a_part_that_raises_is_left_out_and_named_once(glowing, caplog):
    """The other part and the picture stay."""
    for glow in (1.0, 2.0):
        glowing.hear(GlowShown(glow=(glow,) * 3))
        assert look(glowing, (0.0, 1.0, 9.0), (0.0, 9.0, 0.0)).radiance.max() == glow
    assert [record.getMessage() for record in caplog.records] == [
        "the frame part Broken is left out of pictures: ZeroDivisionError: no glow"
    ]


@pytest.mark.gl
def test_a_part_without_messages_is_not_made(glowing):
    """Nobody posts: no program is compiled, nothing is drawn."""
    look(glowing, (0.0, 1.0, 9.0), (0.0, 9.0, 0.0))
    assert glowing.counters.done["glow"] == 0


LIT = """uniform vec3 glow;
Reached surface_light(vec3 face, vec3 smooth_n, vec3 n, bool behind, float occlusion) {
    return Reached(vec4(glow, 0.0), vec4(0.0), false, vec3(0.0), vec3(0.0));
}
vec3 open_irradiance(vec3 n) { return vec3(0.0); }
float light_in_air(float share_of_sky, float metres) { return 1.0; }
"""


class Lighting(FramePart):
    """Lights all surfaces of the scene by the glow as irradiance."""

    hears = (GlowShown,)

    def show(self, heard):
        """Take the irradiance."""
        self.glow = np.array(heard[GlowShown].glow)
        if self.glow[0] < 0.0:
            raise ZeroDivisionError("no light")

    def surface_defines(self, surface):
        """All of the scene."""
        return ("LIT",) if surface.part == 0 else ()

    def bind_surface(self, surface):
        """The same for all."""
        return {"glow": self.glow}

    @classmethod
    def irradiance_at(cls, heard, hit, sky):
        """As the shader."""
        return np.array(heard[GlowShown].glow) if heard and hit.part == 0 else None


class OtherLighting(FramePart):
    """Would light surfaces too."""

    irradiance = Path("other.glsl")


@pytest.fixture
def lit_box(gl_owner, box_file, tmp_path, install, monkeypatch):
    """The box lit by the part `Lighting` under a sky of radiance 1."""
    path = tmp_path / "lit.glsl"
    path.write_text(LIT)
    monkeypatch.setattr(Lighting, "irradiance", path)
    install(A=Lighting, B=OtherLighting)
    backend = PyrenderBackend(gl_owner)
    stage = StatefulBackend(backend, size_px=SIZE, scene=opened(box_file))
    light(stage, uniform_sky(1.0), sun_irradiance=(0.0,) * 3)
    yield stage
    backend.close()


def on_box(stage):
    """Irradiance of the box's top by its picture, whose paint is white under a coat, and lux."""
    seen = look(stage, (0.0, 9.0, 1e-3), (0.0, 0.0, 0.0), 0.1).radiance[12, 16]
    return seen, stage.backend.illuminance(stage.state, (0.1, 2.0, 0.1), (0.0, 1.0, 0.0)).sky_lux


@pytest.mark.gl
def test_a_part_lights_surfaces_in_place_of_the_sky(lit_box, caplog):
    """Twice the irradiance is twice as bright, for picture and light meter; where the part gives
    no more, the open sky lights them. A second part that lights surfaces is left out."""
    under_sky, sky_lux = on_box(lit_box)
    assert list(installed_parts.frame_parts()) == ["A"]
    shown = []
    for glow in (1.0, 2.0):
        lit_box.hear(GlowShown(glow=(glow, glow, glow)))
        shown.append(on_box(lit_box))
    assert shown[0][1] == pytest.approx(683.0)
    np.testing.assert_allclose(shown[1][0], 2.0 * shown[0][0], rtol=1e-5)
    # Without its sky the part leaves a coat dark.
    assert (shown[0][0] < under_sky / np.pi).all()
    lit_box.hear(GlowShown(glow=(-1.0,) * 3))
    np.testing.assert_array_equal(on_box(lit_box)[0], under_sky)
    assert "the frame part A is left out of pictures: ZeroDivisionError: no light" in caplog.text
    assert sky_lux == pytest.approx(np.pi * 683.0, rel=1e-3)


SUN = """float sun_factor(vec3 from_eye) { return LEVEL; }
vec3 ground_factor(vec3 from_eye) { return vec3(LEVEL); }
float sun_factor_end_m(vec3 d, float metres) { return 0.0; }
"""
EXTRA = """int extra_light_count() { return 2; }
vec3 extra_light(int number, vec3 point, vec3 face, out vec3 towards) {
    towards = vec3(0.0, 1.0, 0.0);
    return vec3(number * LEVEL);
}
"""


class HalfSun(FramePart):
    """Dims the sun to a half, or adds a light from above."""

    hears = (GlowShown,)

    @property
    def shades_sun(self):
        """If it dims the sun at all."""
        return self.sun_factor is not None


class QuarterSun(HalfSun):
    """Dims it to a quarter, or adds another light."""


@pytest.mark.gl
@pytest.mark.parametrize(
    ("hook", "glsl", "joined"),
    [("sun_factor", SUN, np.multiply), ("extra_lights", EXTRA, np.add)],
)
def test_several_parts_dim_the_sun_and_add_lights(
    gl_owner, box_file, tmp_path, install, monkeypatch, hook, glsl, joined
):
    """Shares are multiplied and lights added, in one shader with functions of one name each."""
    for part, level in ((HalfSun, "0.5"), (QuarterSun, "0.25")):
        path = tmp_path / f"{part.__name__}.glsl"
        path.write_text(glsl.replace("LEVEL", level))
        monkeypatch.setattr(part, hook, path)
    sun = (1.0,) * 3 if hook == "sun_factor" else (0.0,) * 3
    seen = []
    for parts in ({}, {"a": HalfSun}, {"b-2": QuarterSun}, {"a": HalfSun, "b-2": QuarterSun}):
        install(**parts)
        backend = PyrenderBackend(gl_owner)
        stage = StatefulBackend(backend, size_px=SIZE, scene=opened(box_file))
        light(stage, uniform_sky(0.0), sun_irradiance=sun)
        stage.hear(GlowShown(glow=(1.0,) * 3))
        top = look(stage, (0.0, 9.0, 1e-3), (0.0, 0.0, 0.0), 0.1).radiance[12, 16]
        seen.append(top.astype(float))
        backend.close()
    none, first, second, both = seen
    if hook == "sun_factor":
        first, second, both = (each / none for each in (first, second, both))
        np.testing.assert_allclose((first[0], second[0]), (0.5, 0.25), rtol=1e-5)
    assert first.min() > 0.0
    np.testing.assert_allclose(both, joined(first, second), rtol=1e-5)


@pytest.mark.gl
@pytest.mark.parametrize("hook", ["sun_factor", "extra_lights"])
def test_glsl_that_does_not_compile_is_left_out(
    gl_owner, box_file, tmp_path, install, monkeypatch, caplog, hook
):
    """The picture is drawn without that part, with the others, and the sentence names it."""
    for part, glsl in ((HalfSun, SUN.replace("LEVEL", "0.5")), (QuarterSun, "float broken(")):
        path = tmp_path / f"{part.__name__}.glsl"
        path.write_text(glsl)
        monkeypatch.setattr(part, "sun_factor" if part is HalfSun else hook, path)
    install(good=HalfSun, wrong=QuarterSun)
    backend = PyrenderBackend(gl_owner)
    stage = StatefulBackend(backend, size_px=SIZE, scene=opened(box_file))
    light(stage, uniform_sky(0.0), sun_irradiance=(1.0,) * 3)
    stage.hear(GlowShown(glow=(1.0,) * 3))
    assert look(stage, (0.0, 9.0, 1e-3), (0.0, 0.0, 0.0), 0.1).radiance[12, 16].min() > 0.0
    backend.close()
    assert "the frame part wrong is left out of pictures: its GLSL does not compile" in caplog.text
    assert "good" not in caplog.text


class BrokenClouds(FramePart):
    """Raises where clouds would be prepared."""

    hears = (CloudsChanged,)

    def prepare(self, frame):
        """Fail."""
        raise ZeroDivisionError("no clouds")


@pytest.mark.gl
def test_a_part_that_raises_is_its_modules_fault(install, box_file):
    """The picture is drawn without it; the module of the part's name has the fault."""
    install(clouds=BrokenClouds)
    with Host() as host:
        faults = []
        host.kernel.tap(lambda message, _: faults.append(message))
        host.load(str(box_file))
        host.inject(*daylight_inputs(Project(at="2026-06-21T12:00")))
        host.inject(SetSetting(module="clouds", name="coverage", value=0.5))
        assert np.isfinite(host.draw().radiance).all()
        with pytest.raises(ModuleFailed, match="clouds"):
            host.settle()
    (fault,) = (message for message in faults if isinstance(message, Fault))
    assert fault.module == "clouds"
    assert fault.error.endswith("ZeroDivisionError: no clouds")


class Greedy(FramePart):
    """Asks for more textures than any driver has units."""

    hears = (GlowShown,)
    samplers = tuple(f"texture_{number}" for number in range(1000))

    def show(self, heard):
        """Take the last."""
        self.gl.unit(self.samplers[-1])


@pytest.mark.gl
def test_a_part_gets_no_unit_that_the_driver_lacks(install, gl_owner, box_file, caplog):
    """It is left out with a sentence, where the driver would draw nothing at all."""
    install(Greedy=Greedy)
    backend = PyrenderBackend(gl_owner)
    stage = StatefulBackend(backend, size_px=SIZE, scene=opened(box_file))
    light(stage, uniform_sky(1.0))
    stage.hear(GlowShown(glow=(1.0,) * 3))
    assert look(stage, (0.0, 1.0, 9.0), (0.0, 9.0, 0.0)).radiance.max() == 1.0
    backend.close()
    assert "needs unit 1039" in caplog.text


@pytest.mark.parametrize("hook", installed_parts.HOOKS_OF_ONE)
def test_the_second_part_with_a_hook_is_left_out(install, monkeypatch, hook):
    """Shaders include the GLSL of one: two functions of a name would not compile."""
    for part in (Glow, Broken):
        monkeypatch.setattr(part, hook, Path("any.glsl"))
    install(Broken=Broken, Glow=Glow)
    assert list(installed_parts.frame_parts()) == ["Broken"]
    sentence = f"the frame part Broken has the hook {hook} already"
    assert installed_parts.parts_left_out() == {"Glow": sentence}


def test_modules_names_a_part_that_cannot_be_used(install):
    """The module runs and has its settings, but draws nothing."""
    install(clouds=GlowShown)
    lines = CliRunner().invoke(modules, catch_exceptions=False).output
    of_clouds = lines[lines.index("\nclouds ") :].split("\nd", 1)[0]
    assert "fault: its frame part is left out: it names no subclass of FramePart" in of_clouds
    assert lines.count("is left out") == 1
