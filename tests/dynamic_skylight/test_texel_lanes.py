"""Numbers that vectors load and encode: pads of the tables, and halves by integers."""

import numpy as np
from dynamic_skylight import HosekWilkieSky
from dynamic_skylight.hosek_wilkie import texel_lanes
from dynamic_skylight.hosek_wilkie.sky_tables import AWAY, COEFFICIENT, sky_tables
from dynamic_skylight.hosek_wilkie.texel_lanes import BLOCK, LARGEST_HALF, encode_numbers

from vrut_lite.njit import njit

_STEP = np.uintp(2 * BLOCK)


def test_pads_of_the_tables_are_zero():
    """Maps below 256 texels multiply them; subnormal garbage would take an assist each."""
    garbage = [np.full(2 * AWAY, 1e-41, np.float32) for _ in range(8)]
    del garbage
    sky = HosekWilkieSky(3.0, 0.1, 0.7)
    for table in sky_tables(sky.rgb_distribution, sky.rgb_mean_radiance):
        assert not table[COEFFICIENT - 1 :: COEFFICIENT].any()


def test_halves_by_integers_are_the_nearest(monkeypatch):
    """A processor without halves must draw the same map: ties to even, subnormal, clipped."""
    monkeypatch.setattr(texel_lanes, "has_halves", lambda _context: False)

    @njit
    def encode(out, light):  # type: ignore[no-untyped-def]
        for k in range(np.uintp(0), np.uintp(light.size), _STEP):
            encode_numbers(out, k, light, k)

    halves = np.arange(0x7C00, dtype=np.uint16).view(np.float16).astype(np.float32)
    between = 0.5 * (halves[1:] + halves[:-1])
    light = np.concatenate(
        [halves, between, np.nextafter(between, np.float32(0)), [0.0, 65519.0, 65520.0, 1e30]]
    ).astype(np.float32)
    light = np.pad(light, (0, -light.size % (2 * BLOCK)))
    found = np.empty(light.size, np.uint16)
    encode(found, light)
    expected = np.minimum(light, np.float32(LARGEST_HALF)).astype(np.float16)
    np.testing.assert_array_equal(found.view(np.float16), expected)
