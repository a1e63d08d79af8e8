"""The fast hour against a plain one: the same table, dense matrices in double precision."""

import numpy as np
from boxes import box, floor, hour, quads
from light_transport.hour.key_light import patch_means
from light_transport.hour.relighting import key_shares
from light_transport.hour.smoothing import STEPS
from light_transport.rays.ray_table import columns_and_rays
from light_transport.rays.sky_nodes import NODES, node_radiances
from light_transport.transport import SceneTransport


def plain_hour(transport, now, key_share):
    """Irradiance (texels, 3) by matrices: E = D s + F B, B = M + rho (P E0 + P F B)."""
    texels, patches = len(transport.texels.pixel), len(transport.patches.area)
    table = np.zeros((transport.rows, NODES + patches + 1))
    for row in range(transport.rows):
        own = slice(transport.table.start[row], transport.table.start[row + 1])
        np.add.at(table[row], *columns_and_rays(transport.table.entry[own]))
    table /= np.maximum(transport.table.valid, 1)[:, None]
    d, f = table[:, :NODES], table[:, NODES:-1]
    p = np.zeros((patches, transport.rows))
    for patch in range(patches):
        own = slice(transport.patches.start[patch], transport.patches.start[patch + 1])
        p[patch, transport.patches.member[own]] = transport.patches.weight[own]
    p *= transport.table.valid > 0
    p /= p.sum(axis=1, keepdims=True)
    s = np.pi * node_radiances(now.sky, now.ground_radiance_rgb)
    e = np.empty((texels, 3))
    for c in range(3):
        rho = transport.patches.reflectance_rgb[:, c].astype(float)
        direct = p @ (d @ s[:, c]) + key_share * now.key_irradiance_rgb[c]
        sent = np.linalg.solve(
            np.eye(patches) - rho[:, None] * (p @ f),
            transport.patches.emitted_rgb[:, c] + rho * direct,
        )
        e[:, c] = (d @ s[:, c] + f @ sent)[:texels]
    return e


def smoothed(transport, e):
    smoothing = transport.cache.smoothing
    smooth = after_steps(smoothing, e)
    return at_borders(
        transport, smooth + smoothing.back.astype(float) * after_steps(smoothing, e - smooth)
    )


def at_borders(transport, e):
    """Values of texels at borders, and of those that see surfaces less than two texels away, by
    the frame's look-ups in the map, place by place."""
    texels, finished, shown = transport.texels, transport.cache, e.copy()
    quad = texels.triangle // 2
    fronts = np.flatnonzero(texels.side > 0)
    rows_at = {tuple(at): row for row, at in zip(fronts, texels.pixel[fronts], strict=True)}
    bits = (texels.begins[:, None] >> np.arange(64, dtype=np.uint64)) & np.uint64(1)
    close = (
        transport.table.valid
        < 2.0
        * np.append(texels.width, np.zeros(transport.rows - len(texels.width)))
        * transport.table.nearness
    )
    of_all = bits[fronts].sum(axis=1)
    for row in fronts[finished.good[fronts] & (of_all > 0) & ((of_all < 64) | close[fronts])]:
        column, line = texels.pixel[row]
        mean, own = np.zeros(3), 0.0
        places = np.flatnonzero(bits[row])
        for place in places:
            x, y = column + (place % 8 + 0.5) / 8 - 0.5, line + (place // 8 + 0.5) / 8 - 0.5
            for at in np.ndindex(2, 2):
                tap = int(np.floor(x)) + at[0], int(np.floor(y)) + at[1]
                share = (1.0 - abs(x - tap[0])) * (1.0 - abs(y - tap[1]))
                met = rows_at.get(tap, row)
                met = finished.source[met if quad[met] == quad[row] else row]
                mean += share * e[met] / len(places)
                own += share * (met == row) / len(places)
        change = (e[row] - mean) / max(own, 0.6)
        shown[row] = np.clip(e[row] + change, 0.5 * e[row], 2.0 * e[row])
    return shown


def after_steps(smoothing, e):
    w = smoothing.weights.astype(float)
    for _ in range(STEPS):
        e = e + np.einsum("nk,nkc->nc", w, e[smoothing.links] - e[:, None])
    return e


def test_kernels_agree_with_matrices_in_double_precision():
    """Sky, key light and emission, in a room that is open above and stands across texels of the
    floor around it: within 0.2 % everywhere."""
    walls = [side for k, side in enumerate(box((0, 0, 0), (2, 1, 2), inwards=True)) if k != 2]
    scene = quads(*walls, floor(-3, 5, -3, 5, y=0.1), texels=12, reflectance=[0.8, 0.5, 0.3])
    scene[0].emitted_rgb[:2] = 4.0
    transport = SceneTransport(*scene)
    transport.add_rays(96)
    now = hour(2.0, irradiance=30.0, key=(0.4, 0.8, 0.1))
    finished = transport.cache
    rays, share = finished.key_shadows.rays, key_shares(transport, finished, now)
    expected = smoothed(
        transport, plain_hour(transport, now, patch_means(transport.patches, rays, share))
    )
    assert len(finished.borders.row) > 20
    column, row = transport.texels.pixel.T
    good = transport.cache.good[: len(column)]
    found = transport.light(now).texels[row, column, :3]
    np.testing.assert_allclose(found[good], expected[good], rtol=2e-3)
    assert len(transport.patches.area) < 192


def test_a_sample_of_many_partners_stands_for_all():
    """Patches that see more than 192 others keep an even sample: light is kept, and hardly moved.

    Of small patches in a shut room, one wall of which glows: E of the mean within 0.1 %, and places
    within 2 % rms of matrices that hold all pairs. One sample's mean is off by up to 0.13 % by
    chance, so that the mean is of three rooms.
    """
    off = []
    for texels in (12, 13, 14):
        room = quads(*box((0, 0, 0), (2, 1, 3), inwards=True), texels=texels, reflectance=0.8)
        room[0].emitted_rgb[:2] = 5.0
        transport = SceneTransport(*room, patch_texels=1.0)
        transport.add_rays(768)
        exchange = transport.cache.patch_transfer
        assert np.median(np.diff(transport.table.start)) > 200
        assert np.diff(exchange.start).max() <= 192
        kept = np.add.reduceat(exchange.share, exchange.start[:-1])
        np.testing.assert_allclose(kept, 1.0, rtol=1e-5)
        now = hour()
        expected = smoothed(transport, plain_hour(transport, now, 0.0))
        column, row = transport.texels.pixel.T
        found = transport.light(now).texels[row, column, :3]
        off.append(found.mean() / expected.mean() - 1.0)
        assert np.sqrt(np.mean((found / expected - 1.0) ** 2)) < 0.02
    assert abs(np.mean(off)) < 1e-3
