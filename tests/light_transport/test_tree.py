"""The tree finds what a search through all triangles finds, whatever the triangles are."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from light_transport.rays.simd_intersection import LANES
from light_transport.rays.trace import BEAM, MISS, bound_beam, first_hits, unblocked
from light_transport.rays.tree import LEAF_BITS, STACK, tree_over
from numba import njit


def by_force(corners, origin, direction):
    """Nearest distance (R,) by Cramer's rule in double precision; inf where nothing is met."""
    distances = np.full(len(origin), np.inf)
    for a, b, c in np.asarray(corners, float):
        e1, e2 = b - a, c - a
        p = np.cross(direction, e2)
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1.0 / (p @ e1)
            s = origin - a
            u = np.einsum("ri,ri->r", s, p) * inverse
            q = np.cross(s, e1)
            v = np.einsum("ri,ri->r", direction, q) * inverse
            t = (q @ e2) * inverse
            inside = (u >= 0) & (v >= 0) & (u + v <= 1)
        hit = inside & (t > 0)
        distances = np.where(hit & (t < distances), t, distances)
    return distances


def rays(rng, count):
    direction = rng.normal(size=(count, 3))
    direction[:3] = np.eye(3)
    return rng.uniform(-1, 1, (count, 3)), direction / np.linalg.norm(
        direction, axis=1, keepdims=True
    )


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**31),
    count=st.integers(0, 60),
    size=st.sampled_from([1e-3, 0.1, 1.0]),
    flat=st.booleans(),
    same=st.booleans(),
)
def test_the_nearest_triangle_is_that_of_a_search_through_all(seed, count, size, flat, same):
    """Also in one plane, all at one place, degenerate, or none."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1, 1, (count, 1, 3)) + rng.normal(0, size, (count, 3, 3))
    if flat:
        corners[..., 1] = 0.25
    if same and count:
        corners[:] = corners[0]
    corners[::7, 2] = corners[::7, 1]
    origin, direction = rays(rng, 64)
    hits, distances = first_hits(tree_over(corners, np.ones(count, np.float32)), origin, direction)
    expected = by_force(corners, origin, direction)
    found = np.where(hits == MISS, np.inf, distances.astype(float))
    # Rays within single precision of an edge may go either way.
    agree = np.isclose(found, expected, rtol=1e-3, atol=1e-4) | (found == expected)
    assert agree.mean() > 0.96


def test_triangles_at_one_place_and_of_all_sizes_do_not_deepen_the_tree():
    """The stack of a search has a bound that no scene breaks."""
    sizes = 2.0 ** -np.arange(0, 100, 0.05)
    row = np.zeros((len(sizes), 3, 3))
    row[:, 0, 0] = row[:, 1, 0] = row[:, 2, 0] = sizes
    row[:, 1, 1] = row[:, 2, 2] = sizes
    for corners in (row, np.repeat(row[:1], 3000, axis=0)):
        tree = tree_over(corners, np.ones(len(corners), np.float32))
        depth, level = 0, [0]
        while level:
            depth += 1
            below = tree.child[level].ravel()
            level = below[below >= 0].tolist()
        assert depth < STACK
        codes = -1 - tree.child[tree.child < 0]
        assert (codes & ((1 << LEAF_BITS) - 1)).sum() == len(corners)
        # Of each node in eights all others of its children may wait.
        depth, level = 0, [0]
        while level:
            depth += 1
            below = tree.wide_child[level].ravel()
            level = below[below >= 0].tolist()
        assert (LANES - 1) * depth + 1 < STACK - 3 * LANES
        np.testing.assert_array_equal(
            np.sort(tree.number[tree.number >= 0]), np.arange(len(corners))
        )


def test_no_ray_slips_between_triangles_that_share_an_edge():
    """From within a closed sphere of many triangles every ray meets it."""
    sphere = trimesh.creation.icosphere(4)
    tree = tree_over(np.asarray(sphere.triangles), np.ones(len(sphere.faces), np.float32))
    rng = np.random.default_rng(3)
    # Towards vertices and the middles of edges too.
    towards = np.concatenate(
        [
            sphere.vertices,
            sphere.vertices[sphere.edges_unique].mean(axis=1),
            rng.normal(size=(9999, 3)),
        ]
    )
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    hits, _ = first_hits(tree, np.zeros_like(towards), towards)
    assert (hits != MISS).all()


@pytest.mark.parametrize("opacity", [0.0, 0.25, 1.0])
def test_a_triangle_that_is_not_opaque_stops_its_share_of_rays(opacity):
    """The same rays each time."""
    corners = np.array([[[-9.0, 0.0, -9.0], [9.0, 0.0, -9.0], [0.0, 0.0, 9.0]]])
    tree = tree_over(corners, np.full(1, opacity, np.float32))
    origin = np.random.default_rng(1).uniform(-0.5, 0.5, (4000, 3)) + np.array([0, 1, 0])
    down = np.tile([0.0, -1.0, 0.0], (4000, 1))
    hits, _ = first_hits(tree, origin, down)
    assert (hits != MISS).mean() == pytest.approx(opacity, abs=0.02)
    np.testing.assert_array_equal(hits, first_hits(tree, origin, down)[0])


@njit
def _bounded(beam, count):
    bound_beam(beam, count)


def test_a_beam_finds_what_its_directions_find_one_by_one():
    """Three directions some degrees apart, also about an axis: what is free alone is free."""
    rng = np.random.default_rng(5)
    corners = rng.uniform(-1, 1, (400, 1, 3)) + rng.normal(0, 0.08, (400, 3, 3))
    tree = tree_over(corners, np.ones(len(corners), np.float32))
    origin, middle = rays(rng, 600)
    towards = middle[:, None] + rng.normal(0, 0.03, (600, 3, 3))
    towards /= np.linalg.norm(towards, axis=2, keepdims=True)
    alone = first_hits(tree, np.repeat(origin, 3, axis=0), towards.reshape(-1, 3))[0] == MISS
    stack, beam = np.empty(STACK, np.int32), np.empty(STACK, np.float32)
    likely, found = MISS, []
    for place, three in zip(origin.astype(np.float32), towards, strict=True):
        beam[BEAM : BEAM + 9] = three.ravel()
        _bounded(beam, 3)
        free, blocker = unblocked(tree, *place, beam, 3, 7, 0, stack, likely)
        likely = blocker if blocker != MISS else likely
        found.append([free >> d & 1 for d in range(3)])
    assert 0.1 < alone.mean() < 0.9
    np.testing.assert_array_equal(np.ravel(found), alone)
    one = unblocked(tree, *place, beam, 3, 0b010, 0, stack, MISS)[0]
    assert one == free & 0b010
