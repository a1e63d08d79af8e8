"""Edges of moving pictures are smoothed as the published filter says, by a plain twin."""

import numpy as np
import pytest

from vrut_lite.render.software.edge_kernel import smooth_edges


def toned(rgb):
    """As the tone map leaves a picture (h, w, 3), luma in alpha."""
    luma = np.rint(rgb @ [0.2126, 0.7152, 0.0722])
    return np.dstack([rgb, luma]).astype(np.uint8)


def shown(picture):
    out = np.empty((*picture.shape[:2], 3), np.uint8)
    pixels = np.ascontiguousarray(picture).view("<u4")[..., 0]
    # In two parts, as on two threads.
    smooth_edges(pixels, out, len(pixels) // 3, len(pixels))
    smooth_edges(pixels, out, 0, len(pixels) // 3)
    return out


def looked_up(picture, x, y):
    """Linear between pixels (h, w, 4) at places (h, w); those beyond the border repeat it."""
    left, lower = np.floor(x).astype(int), np.floor(y).astype(int)
    total = np.zeros(picture.shape)
    for j in (0, 1):
        for i in (0, 1):
            share = np.abs(1 - i - (x - left)) * np.abs(1 - j - (y - lower))
            row = np.clip(lower + j, 0, picture.shape[0] - 1)
            column = np.clip(left + i, 0, picture.shape[1] - 1)
            total += share[..., None] * picture[row, column]
    return total


def published(picture):
    """FXAA's short form (Lottes 2009) in float64, of the whole picture; row 0 at the top."""
    picture = picture / 255.0
    y, x = np.mgrid[: picture.shape[0], : picture.shape[1]].astype(float)
    sw, se, nw, ne = (
        looked_up(picture, x + i, y + j)[..., 3] for j in (-0.5, 0.5) for i in (-0.5, 0.5)
    )
    lumas = np.stack([picture[..., 3], sw, se, nw, ne])
    darkest, brightest = lumas.min(0), lumas.max(0)
    right, up = nw + ne - sw - se, nw + sw - ne - se
    least = np.maximum(0.03 * (nw + ne + sw + se), 1.0 / 128.0)
    steepness = np.minimum(np.abs(right), np.abs(up)) + least
    right, up = np.clip(right / steepness, -8, 8), np.clip(up / steepness, -8, 8)

    def pair(share):
        return looked_up(picture, x - share * right, y - share * up) + looked_up(
            picture, x + share * right, y + share * up
        )

    near = 0.5 * pair(1 / 6)
    far = 0.5 * near + 0.25 * pair(1 / 2)
    outside = (far[..., 3] < darkest) | (far[..., 3] > brightest)
    found = np.where(outside[..., None], near, far)
    flat = brightest - darkest <= 0.03
    return (255.0 * np.where(flat[..., None], picture, found)[..., :3])[::-1]


@pytest.mark.parametrize("seed", range(3))
def test_the_kernel_is_the_published_filter(seed):
    """Noise, slopes and the picture's own border, by places and shares in parts of 256."""
    chance = np.random.default_rng(seed)
    rgb = np.kron(chance.integers(0, 256, (9, 13, 3)), np.ones((4, 5, 1)))
    rgb += chance.integers(-3, 4, rgb.shape)
    picture = toned(np.clip(rgb, 0, 255))
    off = np.abs(shown(picture) - published(picture)).max(axis=-1)
    # A mean that is as light as the lightest neighbour may fall to either side.
    assert (off > 2.0).mean() < 5e-3
    assert np.median(off) < 0.6


def test_what_has_no_edge_stays_as_it_is_and_a_step_is_smoothed():
    """Row 0 of what is read is at the bottom; a slanted edge gets tones between its sides."""
    smooth = toned(np.broadcast_to(np.linspace(20, 90, 64)[:, None, None], (64, 48, 3)))
    np.testing.assert_array_equal(shown(smooth), smooth[::-1, :, :3])
    y, x = np.mgrid[:64, :48]
    slanted = toned(np.where((x > 0.3 * y + 10)[..., None], (200, 180, 90), (30, 60, 40)))
    between = shown(slanted)[..., 0]
    steps = ((between > 60) & (between < 170)).sum(axis=1)
    assert np.median(steps) >= 1
    np.testing.assert_array_equal(shown(slanted)[:, :5], slanted[::-1, :5, :3])
