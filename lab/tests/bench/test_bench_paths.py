"""One small path of each computation: it runs, and its error is the known one."""

import msgspec
import numpy as np
import pytest
from light_transport.module import LightTransport
from light_transport.settings import LightTransportSettings

from vrut_lite_lab.bench import sky_truth
from vrut_lite_lab.bench.bench_path import BenchPath, Errors
from vrut_lite_lab.bench.gl import close_gl
from vrut_lite_lab.bench.paths import (
    air,
    dispatch,
    first_light,
    frame,
    hosek_wilkie,
    light_map,
    single_scattering,
    sky_view,
    solver,
    sun,
    tables,
    window,
)

pytestmark = pytest.mark.long


def path_of(groups, name: str) -> BenchPath:
    """The path of a name in any of the groups."""
    return next(path for group in groups for path in group.paths if path.name == name)


def errors_of(path: BenchPath) -> dict[str, Errors]:
    """Run it once, and judge."""
    assert path.error is not None
    found = path.error(path.prepare()())
    assert found
    assert all(np.isfinite(msgspec.structs.astuple(each)).all() for each in found.values())
    return found


@pytest.fixture(autouse=True)
def coarse_truth(monkeypatch):
    """The converged solver takes seconds: here the product's own sizes stand for it."""
    from bruneton_sky.solver import SolverSizes

    monkeypatch.setattr(sky_truth, "_QUICK_SIZES", SolverSizes.in_clear_air())
    sky_truth.exact_skies.cache_clear()
    yield
    sky_truth.exact_skies.cache_clear()
    close_gl()


def test_sun() -> None:
    """The ephemeris is within 0.001 degrees of NREL's SPA, as `sun_position` promises."""
    pytest.importorskip("pvlib", reason="the extra `test` is not installed")
    (found,) = errors_of(path_of(sun.groups(True), "ephemeris")).values()
    assert found.largest < np.radians(1e-3)


@pytest.mark.parametrize(
    ("name", "most"),
    [
        ("cube_map, float32, 64²", 1e-4),
        ("cube_map_float16, 64²", 2.0**-10),
        ("float64 twin, 64²", 1e-12),
        ("float32, 64²", 0.1),
    ],
)
def test_hosek_wilkie(name: str, most: float) -> None:
    """The fast map promises 1e-4, a half has eleven bits, double precision is the formula, and a
    look-up between texels of 1.4 degrees errs by some percent near the horizon."""
    found = errors_of(path_of(hosek_wilkie.groups(True), name))
    assert len(found) == 5
    assert max(each.p99 for each in found.values()) < most


def test_single_scattering() -> None:
    """The compiled rule errs as its float64 twin does, to rounding."""
    groups = single_scattering.groups(True)
    compiled = errors_of(path_of(groups, "compiled, gauss-legendre, 12 nodes"))
    twin = errors_of(path_of(groups, "numpy, gauss-legendre, 12 nodes"))
    for name, each in twin.items():
        assert compiled[name].mean == pytest.approx(each.mean, rel=1e-3, abs=1e-9)


def test_solver() -> None:
    """Two orders miss what the third and later add: up to half of the light in twilight's darkest
    parts; the product's sizes against themselves are off by where the orders end, 1 % at most."""
    groups = solver.groups(True)
    two = errors_of(path_of(groups, "2 orders"))
    every = errors_of(path_of(groups, "rung usual"))
    assert 0.3 < two["sun -4°, 0 m up"].p99 < 0.6
    assert max(each.p99 for each in every.values()) < 0.01


def test_sky_view() -> None:
    """A table half as fine errs by more than the product's, which misses 99 % of
    the picture by less than a percent."""
    groups = sky_view.groups(True)
    ours = errors_of(path_of(groups, "1 times as fine"))
    small = errors_of(path_of(groups, "0.5 times as fine"))
    assert max(each.p99 for each in ours.values()) < 0.01
    assert all(small[name].mean > each.mean for name, each in ours.items())


def test_tables() -> None:
    """The published pipeline and the fast solver at a quarter of the published sizes: by day both
    are within a fifth of the truth, which small tables miss near the horizon."""
    found = errors_of(path_of(tables.groups(True), "fast solver, 4 orders, quarter size"))
    assert found["sun 60°, 0 m up"].mean < 0.2


def test_air() -> None:
    """The product's volume: 99 % of walls within 2 % of the float64 twin by day."""
    found = errors_of(path_of(air.groups(True), "the product's"))
    assert max(each.p99 for each in found.values()) < 0.02


def test_light_map() -> None:
    """Four times the rays: less error under both suns, and a tenth of the light at most."""
    groups = light_map.groups(True)
    few, more = (errors_of(path_of(groups, f"{rays} rays, 7500 texels")) for rays in (16, 64))
    assert all(more[sun].mean < few[sun].mean for sun in few)
    assert max(each.mean for each in more.values()) < 0.12


@pytest.mark.parametrize("subscribers", [1, 4])
def test_dispatch(subscribers: int) -> None:
    """Every subscriber hears each message once, and goes on hearing in later rounds."""
    group = dispatch.groups(True)[(1, 4).index(subscribers)]
    for path in group.paths:
        work = path.prepare()
        assert path.error is not None
        assert path.error(work()) == {}
        counters = work()
        assert [counter.count for counter in counters] == [2 * dispatch.MESSAGES] * subscribers


def test_a_figure_of_the_window_is_used_once(monkeypatch) -> None:
    """A second timing of the window starts a new process instead of repeating the first figure."""
    runs = iter((0.2, 0.1))

    def measure(group: str) -> dict[str, float]:
        assert group == "window-latency"
        return dict.fromkeys(window._LATENCY, next(runs))

    monkeypatch.setattr(window, "_measure", measure)
    monkeypatch.setattr(window, "_measured", {})
    first, second = (window._path("window-latency", name) for name in window._LATENCY[:2])
    told = [path.clock.time(path.prepare()).seconds for path in (first, second, first, second)]
    assert told == [0.2, 0.2, 0.1, 0.1]


@pytest.mark.gl
def test_shaders() -> None:
    """A half has eleven bits; single scattering in float32 errs by 1e-4 at most by day."""
    half = errors_of(path_of(hosek_wilkie.groups(True), "GPU shader, float16, 64²"))
    rule = "GPU shader, gauss-legendre, 12 nodes"
    once = errors_of(path_of(single_scattering.groups(True), rule))
    assert max(each.p99 for each in half.values()) < 2.0**-10
    assert max(each.p99 for each in once.values()) < 1e-4


@pytest.mark.gl
def test_frame() -> None:
    """A pass is a part of the frame: it takes time, and less than the frame it was timed in."""
    path = path_of(frame.groups(True), "sky, 320 x 200")
    spent = path.clock.time(path.prepare())
    assert 0.0 < spent.seconds < 2 * spent.wall_s + 1.0


def test_first_light(monkeypatch) -> None:
    """It comes after its scene, in less CPU time than all rays take."""
    # Tests elsewhere switch it off.
    monkeypatch.setattr(LightTransport, "settings_type", LightTransportSettings)
    clock = path_of(first_light.groups(True), "work/indoor.glb").clock
    spent = clock.time(lambda: None)
    assert 0.0 < spent.seconds < 60.0
    assert spent.wall_s > 0.0
