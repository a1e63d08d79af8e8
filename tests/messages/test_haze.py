"""One haze for every sky: a host input that skies follow, unless their own settings name one."""

import msgspec
import pytest
from bruneton_sky.module import BrunetonSky
from command_output import shared_options
from dynamic_skylight.module import DynamicSkyLight

from vrut_lite.array import Array
from vrut_lite.atmosphere.aerosol import (
    optical_depth_of_turbidity,
    turbidity_of_optical_depth,
)
from vrut_lite.atmosphere.aerosols.own import OwnAerosol
from vrut_lite.daylight_kernel import daylight_kernel
from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Demand, SetSetting
from vrut_lite.messages.haze import DEFAULT_HAZE, MOST_OPTICAL_DEPTH, SetHaze
from vrut_lite.messages.sky import AmbientChanged, BackgroundChanged
from vrut_lite.project import (
    Haze,
    Project,
    daylight_inputs,
    load_project,
    save_project,
    setting_inputs,
)
from vrut_lite.testing.sky_on_bus import SkyOnBus

SKIES = ("dynamic_skylight", "bruneton_sky")
HAZY = SetHaze(optical_depth_550=float(optical_depth_of_turbidity(6.0)))


@pytest.fixture(scope="module", params=SKIES)
def shown(request):
    """A sky at noon, with inputs in addition to those of a default project."""
    sky, known = request.param, {}

    def ask(*inputs):
        if inputs not in known:
            kernel, failures = daylight_kernel()
            assert not failures
            project = Project(slots={"sky": sky})
            # Asked for at the end, so that one sky is made.
            demand = Demand(consumer="test", message="BackgroundChanged", size=16)
            said_before = *setting_inputs(project, kernel), *daylight_inputs(project)
            for message in (*said_before, *inputs, demand):
                kernel.inject(message)
                kernel.pump()
            kernel.pump_until_idle()
            said = kernel.last(BackgroundChanged)
            assert said.source == sky
            assert isinstance(said.cube, Array)
            known[inputs] = said.cube.digest, said.radiance_scale
            kernel.close()
        return known[inputs]

    ask.sky = sky
    return ask


def test_a_sky_follows_the_haze(shown):
    """More haze is another sky; the default haze, set explicitly, is the default sky."""
    assert shown(HAZY) != shown()
    assert shown(DEFAULT_HAZE) == shown()


def test_a_turbidity_of_its_own_overrides_the_haze(shown):
    """A number is that sky's own, as in projects and journals of before; none follows again."""
    own = SetSetting(module=shown.sky, name="turbidity", value=6.0)
    follows = SetSetting(module=shown.sky, name="turbidity", value=None)
    assert shown(own) == shown(own, DEFAULT_HAZE) == shown(DEFAULT_HAZE, own)
    assert shown(own, follows) == shown()


def test_turbidity_is_an_alias():
    """Preetham's scale: 3 is 0.20, there and back to the digit; a sky of either is the same."""
    assert pytest.approx(0.20, abs=0.002) == DEFAULT_HAZE.optical_depth_550
    for turbidity in (1.0, 2.0, 3.0, 4.56, 10.0):
        depth = float(optical_depth_of_turbidity(turbidity))
        assert turbidity_of_optical_depth(depth) == turbidity
    assert SetHaze(optical_depth_550=MOST_OPTICAL_DEPTH).turbidity == 10.0
    sky = SkyOnBus(DynamicSkyLight)
    sky.want(AmbientChanged)
    sky.sun(40.0)
    sky.tell(HAZY)
    by_depth = sky.last(AmbientChanged).irradiance_sh_rgb.digest
    sky.tell(DEFAULT_HAZE)
    assert sky.last(AmbientChanged).irradiance_sh_rgb.digest != by_depth
    sky.set("turbidity", 6.0)
    assert sky.last(AmbientChanged).irradiance_sh_rgb.digest == by_depth


@pytest.mark.long
@pytest.mark.parametrize("depth", [0.0, MOST_OPTICAL_DEPTH])
def test_the_ends_of_the_scale_are_skies(shown, depth):
    """Air without aerosol is clearer than turbidity 1, and the haziest is turbidity 10."""
    end = shown(SetHaze(optical_depth_550=depth))
    assert end != shown()
    if depth:
        assert end == shown(SetSetting(module=shown.sky, name="turbidity", value=10.0))


def test_a_preset_brings_its_own_haze():
    """The place's haze changes the air of today's Earth, and leaves that of Mars unsolved."""
    sky = SkyOnBus(BrunetonSky, preset="earth-clear")
    sky.want(AmbientChanged)
    sky.sun(40.0)
    sky.taken()
    sky.holding = True
    sky.tell(HAZY)
    assert sky.held == []
    assert sky.taken() == []
    sky.set("turbidity", 6.0)
    assert sky.held == ["solve"]


def test_an_aerosol_of_ones_own_takes_the_types_place(shown, tmp_path):
    """By exponent, albedo and a phase function, of which the Bruneton sky makes light; another
    type on the command line puts it away, and what is impossible is refused in a sentence."""
    own = OwnAerosol(1.5, 0.8, angle_deg=(0.0, 30.0, 180.0), phase=(20.0, 2.0, 0.5))
    haze = SetHaze(optical_depth_550=0.4, own=own)
    assert haze.optics.angstrom_exponent == pytest.approx(1.5)
    assert haze.optics.albedo_at(550.0) == pytest.approx(0.8)
    assert shown(haze) != shown(SetHaze(optical_depth_550=0.4))
    project = Project(haze=Haze(0.4, own=own))
    save_project(tmp_path / "p.toml", project)
    assert load_project(tmp_path / "p.toml").haze.input() == haze
    assert project_of("--haze", "0.2", project=project).haze.own == own
    assert project_of("--aerosol", "desert", project=project).haze.own is None
    with pytest.raises(UserError, match="own aerosol of haze: albedo must lie between 0 and 1"):
        SetHaze(optical_depth_550=0.4, own=OwnAerosol(albedo=2.0)).check()


# --- command line and project ------------------------------------------------------------


def project_of(*arguments, project=None):
    """The project that the shared options make."""
    return shared_options(*arguments, project=project)[0]


def test_the_command_line_says_haze_by_depth_or_turbidity():
    """One input for every sky; without either there is none, and sessions are as before."""
    assert project_of().haze is None
    assert project_of("--haze", "0.3").haze == Haze(0.3)
    assert project_of("--turbidity", "6").haze == Haze(HAZY.optical_depth_550)
    assert not project_of("--turbidity", "6").settings.get("bruneton_sky")


def test_the_command_line_overrides_what_a_project_sets():
    """A sky's own haze goes, whatever else the project sets stays, and --set names one sky's."""
    before = Project(settings={sky: {"turbidity": 5.0, "albedo": 0.2} for sky in SKIES})
    assert project_of(project=before).settings == before.settings
    after = project_of("--haze", "0.1", "--set", "bruneton_sky.turbidity=2", project=before)
    assert after.settings == {
        "dynamic_skylight": {"albedo": 0.2},
        "bruneton_sky": {"albedo": 0.2, "turbidity": "2"},
    }


def test_the_stratosphere_is_a_part_of_the_column():
    """The layers add to the depth that was set, with background, eruption and none; more than all
    of it is all of it. One lobe is one layer."""
    for depth, high in ((0.2, 0.005), (0.2, 0.0), (0.2, 0.15), (0.01, 0.1), (0.0, 0.005)):
        haze = SetHaze(optical_depth_550=depth, stratosphere_depth_550=high)
        depths = [layer.depth_at([550.0])[0] for layer in haze.aerosol_layers]
        assert sum(depths) == pytest.approx(depth)
        assert len(depths) == (3 if min(depth, high) > 0.0 else 2)
        assert depths[2:] in ([], [pytest.approx(min(depth, high))])
    peak_m = SetHaze(optical_depth_550=0.2, stratosphere_peak_km=25.0).layers[-1].peak_m
    assert peak_m == 25_000.0
    lobe = SetHaze(optical_depth_550=0.2, aerosol="one-lobe", stratosphere_depth_550=0.1)
    assert [layer.peak_m for layer in lobe.aerosol_layers] == [None, None]
    assert lobe.troposphere_depth_550 == 0.2


@pytest.mark.parametrize("aerosol", ["continental-average", "one-lobe"])
def test_the_height_of_the_haze_changes_its_lower_layer_alone(aerosol):
    """Its column stays; both skies and the night take the layers."""
    haze = SetHaze(optical_depth_550=0.2, aerosol=aerosol)
    high = msgspec.structs.replace(haze, scale_height_m=3000.0)
    for usual, now in zip(haze.aerosol_layers, high.aerosol_layers, strict=True):
        assert now.depth_at([450.0, 550.0]) == pytest.approx(usual.depth_at([450.0, 550.0]))
    assert [layer.height_m for layer in high.layers[1:]] == [
        layer.height_m for layer in haze.layers[1:]
    ]
    assert high.layers[0].height_m == 3000.0


@pytest.mark.parametrize(
    ("field", "value"),
    [("scale_height_m", 10.0), ("stratosphere_depth_550", 0.4), ("stratosphere_peak_km", 5.0)],
)
def test_an_impossible_layer_is_refused(field, value):
    """By the field's name."""
    with pytest.raises(UserError, match=field):
        SetHaze(**{"optical_depth_550": 0.2, field: value}).check()
