"""The precomputation's shaders against Bruneton's own tables and the twin in double precision.

Errors are over the largest value of a table. 1e-3 is asked for; on llvmpipe 1.2e-5 is reached
where rays are followed, and 2.2e-6 elsewhere.
"""

from dataclasses import fields, replace

import grazing_ray
import numpy as np
import pytest
from bruneton_reference import SIZES, STEPS, reference, reference_atmosphere
from bruneton_sky import Atmosphere
from bruneton_sky.published.gpu_pipeline import GpuPipeline, passes, pipeline
from bruneton_sky.published.pipeline.pipeline import run_pipeline
from bruneton_sky.tables.sizes import TableSizes
from gpu_steps import gpu_steps

from vrut_lite.errors import UserError

# The product never imports the reference: it changes seldom.
pytestmark = [pytest.mark.gl, pytest.mark.long]
# No two alike and none of them even but mu, which must be: swapped axes would show.
ODD = TableSizes(
    transmittance_altitude=11, transmittance_mu=23, irradiance_altitude=3, irradiance_mu_s=9,
    altitude=7, mu=12, nu=5, mu_s=6,
)  # fmt: skip
FLAT, RAYS = 1e-5, 5e-5
TOLERANCE = {
    "transmittance": FLAT,
    "delta_irradiance": FLAT,
    "scattering_density": FLAT,
    "single_rayleigh": RAYS,
    "single_mie": RAYS,
    "delta_multiple_scattering": RAYS,
}
TABLES = ("transmittance", "irradiance", "scattering", "single_mie")


def assert_near(made, exact, tolerance, label):
    """Finite, and within a share of the largest value."""
    assert made.shape == exact.shape
    assert np.all(np.isfinite(made)), label
    assert np.abs(made - exact).max() <= tolerance * exact.max(), label


@pytest.fixture(scope="module")
def make(gl_owner):
    """Does something with a pipeline of some sizes, on the GL thread."""
    made = {}

    def call(sizes, work):
        def on_thread(context):
            if sizes not in made:
                made[sizes] = GpuPipeline(context, sizes)
            return work(made[sizes])

        return gl_owner.call(on_thread)

    yield call
    gl_owner.call(lambda _: [one.release() for one in made.values()])


@pytest.fixture(scope="module")
def reference_steps(make):
    """Every table of four orders, with the numbers of Bruneton's."""
    return make(SIZES, lambda p: gpu_steps(p, reference_atmosphere(), 4))


@pytest.fixture(scope="module")
def hazy_planet() -> Atmosphere:
    """A small planet with five wavelengths, through whose haze no light comes along the ground."""
    planet = Atmosphere(
        wavelength_nm=(700.0, 600.0, 500.0, 400.0, 300.0),
        solar_irradiance=(0.7, 0.9, 1.1, 0.8, 0.5),
        ground_radius_m=3_000_000.0,
        top_altitude_m=90_000.0,
        rayleigh_scattering=(4e-6, 7e-6, 1.5e-5, 3.7e-5, 1e-4),
        rayleigh_scale_height_m=11_000.0,
        mie_scattering=(2e-5, 3e-5, 4e-5, 6e-5, 1.2e-3),
        mie_extinction=(3e-5, 4e-5, 5e-5, 7e-5, 1.4e-3),
        mie_scale_height_m=2300.0,
        mie_g=0.6,
        absorption_extinction=(1e-6, 0.0, 2e-6, 5e-7, 3e-5),
        absorber_altitude_m=(5000.0, 20_000.0, 30_000.0, 50_000.0),
        absorber_density=(0.2, 1.0, 0.5, 0.0),
        ground_albedo=(0.3, 0.2, 0.1, 0.1, 0.9),
        sun_angular_radius_rad=0.01,
        mu_s_min=-0.3,
        mie_phase="henyey-greenstein",
    )
    horizon_depth = planet.mie_extinction[-1] * np.sqrt(
        0.5 * np.pi * planet.ground_radius_m * planet.mie_scale_height_m
    )
    assert horizon_depth > 104, "exp(-104) is nothing in single precision"
    return planet


@pytest.mark.parametrize(
    ("name", "order", "key"),
    STEPS,
)
def test_each_shader_makes_brunetons_table(reference_steps, name, order, key):
    """Every intermediate of every order, against his implementation of 2017 in float64."""
    assert_near(reference_steps[name, order], reference()[key], TOLERANCE[name], key)


def test_the_tables_of_four_orders_are_brunetons(make):
    """The sums of all orders, read back as `Tables`."""
    tables = make(SIZES, lambda p: p.run(reference_atmosphere(), 4))
    assert (tables.orders, tables.parametrisation) == (4, "2017")
    for name in TABLES:
        assert_near(getattr(tables, name), reference()[name], RAYS, name)


def test_a_planet_of_haze_in_five_wavelengths(make, hazy_planet):
    """Against the twin: no number of Earth is in a shader, and wavelengths go in fours.

    Its transmittances along the ground underflow in single precision; their ratios must not,
    or the haze at the horizon would be black. Rays from aloft that graze the ground are left to
    the next test: for them rounding in float64 spoils the twin, which passes 2e-4 of it on to
    later orders.
    """
    exact = run_pipeline(hazy_planet, ODD, 3)
    made = make(ODD, lambda p: p.run(hazy_planet, 3))
    for name in TABLES:
        values, truth = getattr(made, name), getattr(exact, name)
        if values.ndim == 5:
            values[1:, -1] = truth[1:, -1]
        assert_near(values, truth, 5e-4, name)
    assert made.single_mie[0, -1, :, -1, -1].min() > 0.01


def test_rays_that_graze_the_ground_in_haze(make, hazy_planet):
    """Exact in distances from the tangent point; in the haziest wavelength the twin errs by 71 %.

    There the table falls by e^100 between two nodes: a metre along the ray is 1 %.
    """
    table = make(ODD, lambda p: p.run(hazy_planet, 1)).single_mie
    for altitude in range(ODD.altitude - 1):
        for nu, mu_s in ((0, 5), (2, 5), (4, 4)):
            exact = grazing_ray.single_mie(hazy_planet, ODD, altitude, nu, mu_s)
            made = table[altitude, -1, nu, mu_s]
            assert_near(made, exact, RAYS, (altitude, nu, mu_s))
            np.testing.assert_allclose(made[-1], exact[-1], rtol=1e-2)


def test_a_planet_by_every_step(make, other_planet):
    """Orders two and three of an arbitrary planet, table by table, on axes of odd sizes."""
    exact = {}
    run_pipeline(
        other_planet,
        ODD,
        3,
        observe=lambda *step: exact.update({step[:2]: step[2].copy()}),
    )
    made = make(ODD, lambda p: gpu_steps(p, other_planet, 3))
    assert made.keys() == exact.keys()
    for (name, order), array in exact.items():
        assert_near(made[name, order], array, TOLERANCE[name], (name, order))


def test_another_atmosphere_compiles_nothing(make, other_planet, monkeypatch):
    """Parameters are numbers in a buffer: the same programs give the other planet's tables."""
    before = make(ODD, lambda p: p.run(other_planet, 2))
    programs = make(ODD, lambda p: {name: p.glo for name, p in p.programs.items()})

    def refuse(*_):
        raise AssertionError("a shader was compiled")

    monkeypatch.setattr(pipeline, "compile_programs", refuse)
    nodes = {"absorber_altitude_m": (0.0, 9000.0), "absorber_density": (1.0, 0.0)}
    changed = replace(other_planet, mie_g=-0.2, top_altitude_m=70_000.0, **nodes)
    other = make(ODD, lambda p: p.run(changed, 2))
    again = make(ODD, lambda p: p.run(other_planet, 2))
    assert make(ODD, lambda p: {name: p.glo for name, p in p.programs.items()}) == programs
    assert np.abs(other.scattering - before.scattering).max() > 0.01 * before.scattering.max()
    for name in TABLES:
        np.testing.assert_array_equal(getattr(again, name), getattr(before, name))


def test_one_order_is_light_scattered_once(make, other_planet):
    """No light of the sky falls on the ground, and nothing is added to Rayleigh's part."""
    tables = make(ODD, lambda p: p.run(other_planet, 1))
    steps = make(ODD, lambda p: gpu_steps(p, other_planet, 1))
    np.testing.assert_array_equal(tables.scattering, steps["single_rayleigh", 1])
    assert not tables.irradiance.any()
    assert tables.orders == 1


def test_other_gl_work_may_run_between_slices(make, other_planet, monkeypatch):
    """A frame drawn in between binds its own textures; slices of one altitude change nothing."""
    monkeypatch.setattr(passes, "LAYERS_AT_ONCE", 1)

    def interrupted(p):
        other = p.context.texture((4, 4), 4, dtype="f4")
        slices, shares = p.slices(other_planet, 2), []
        while True:
            try:
                shares.append(next(slices))
            except StopIteration as end:
                (tables,) = end.value
                made = np.frombuffer(tables.scattering.read(), np.float32)
                tables.release()
                other.release()
                return shares, made
            for unit in range(4):
                other.use(unit)
                other.bind_to_image(unit % 2, read=True, write=True)

    shares, made = make(ODD, interrupted)
    whole = make(ODD, lambda p: p.run(other_planet, 2))
    np.testing.assert_array_equal(made.reshape(whole.scattering.shape), whole.scattering)
    assert len(shares) >= 3 * ODD.altitude
    assert shares == sorted(shares)


def test_progress_rises_to_one(make, other_planet):
    """The share done never falls and ends at 1."""
    told = []
    make(ODD, lambda p: p.run(other_planet, 2, told.append))
    assert told == sorted(told)
    assert told[0] < 0.2
    assert told[-1] == 1.0


def test_pipeline_makes_a_context_where_none_is_given(other_planet, make):
    """Without a context one is made; the tables are the same."""
    with GpuPipeline(sizes=ODD) as own:
        alone = own.run(other_planet, 2)
    shared = make(ODD, lambda p: p.run(other_planet, 2))
    for field in fields(alone):
        if field.name in TABLES:
            np.testing.assert_array_equal(getattr(alone, field.name), getattr(shared, field.name))


def test_missing_opengl_is_told_in_one_sentence(monkeypatch):
    """The refusal names the reason, and the CPU as the way out."""
    import moderngl

    def fail(**_):
        raise Exception("no device")

    monkeypatch.setattr(moderngl, "create_context", fail)
    with pytest.raises(UserError, match=r"no OpenGL.*no device.*precompute on the CPU"):
        GpuPipeline()


def test_no_orders_and_too_large_axes_are_refused(make, other_planet):
    """Zero orders, and an axis too long for a work group's memory, are refused."""
    with pytest.raises(ValueError, match="orders must be 1 or more"):
        make(ODD, lambda p: p.run(other_planet, 0))
    with pytest.raises(ValueError, match="shared memory"):
        GpuPipeline(sizes=replace(ODD, nu=64))
