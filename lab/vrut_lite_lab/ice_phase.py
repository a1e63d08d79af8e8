"""Make modules/clouds/model/data/ice_crystals.npz: the phase function of hexagonal columns of ice.

    python -m vrut_lite_lab.ice_phase

Ray optics (after Macke, Mueller and Raschke 1996, "Single Scattering Properties of Atmospheric Ice
Crystals"): smooth columns twice as long as wide in random orientation, Fresnel's shares drawn by
lot for unpolarised light, no absorption, ice's refractive index by Warren and Brandt 2008. The
minimum deviation by two sides that enclose 60 degrees is the halo, at 2 arcsin(n / 2) - 60 = 21.9
degrees for 550 nm. Rays that keep their direction, through parallel faces, count as not scattered;
so does diffraction, whose peak is narrower than the sun's disc. Most crystals are no such columns:
with 20 % of them (within what halos of real clouds show: van Diedenhoven 2014) the others scatter
by one smooth lobe of the same mean cosine.
"""

import math

import numpy as np

from vrut_lite.atmosphere.aerosols import PhaseTable
from vrut_lite.atmosphere.aerosols.phase_table import PHASE_NODES, node_cosines
from vrut_lite.njit import njit
from vrut_lite.numeric_types import FloatArray
from vrut_lite_lab.checkout import ROOT

TARGET = ROOT / "modules" / "clouds" / "model" / "data" / "ice_crystals.npz"
WAVELENGTH_NM = np.array([475.0, 550.0, 625.0])
ICE = np.array([1.3138, 1.3110, 1.3089])
# Half the length over the edge of the hexagon.
_HALF_LENGTH = 2.0
_APOTHEM = 0.5 * math.sqrt(3.0)
_SMOOTH_SHARE = 0.2
_RAYS, _MOST_BOUNCES = 6_000_000, 40
# Cosine above which a ray has kept its direction.
_UNDEVIATED = 1.0 - 1e-9


@njit(cache=True)
def fresnel(cosine, n):  # type: ignore[no-untyped-def]
    """Share of unpolarised light that a face reflects, and the cosine behind it.

    `n`: index behind the face over that before it; the share is 1 where nothing passes.
    """
    squared = 1.0 - (1.0 - cosine * cosine) / (n * n)
    if squared <= 0.0:
        return 1.0, 0.0
    behind = math.sqrt(squared)
    s = (cosine - n * behind) / (cosine + n * behind)
    p = (n * cosine - behind) / (n * cosine + behind)
    return 0.5 * (s * s + p * p), behind


@njit(cache=True)
def _bend(d, normal, cosine, behind, n):  # type: ignore[no-untyped-def]
    """Refract a direction in place; the normal points against it."""
    for c in range(3):
        d[c] = d[c] / n + (cosine / n - behind) * normal[c]


@njit(cache=True)
def trace(normals, distances, areas, n, rays, random, counts):  # type: ignore[no-untyped-def]
    """Count rays by sin(theta / 2) into bins; returns how many kept their direction."""
    bins, kept = counts.shape[0], 0
    d, at, side, came = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
    facing = np.zeros(8)
    for _ in range(rays):
        mu, turn = random.uniform(-1.0, 1.0), random.uniform(0.0, 2.0 * math.pi)
        level = math.sqrt(1.0 - mu * mu)
        came[0], came[1], came[2] = level * math.cos(turn), level * math.sin(turn), mu
        d[:] = came
        total = 0.0
        for f in range(8):
            total += areas[f] * max(-(normals[f] @ d), 0.0)
            facing[f] = total
        lot, face = random.random() * total, 0
        while facing[face] < lot:
            face += 1
        # A place on the face: a rectangle, or a hexagon by rejection.
        if face < 6:
            s, z = random.uniform(-0.5, 0.5), random.uniform(-_HALF_LENGTH, _HALF_LENGTH)
            at[0] = _APOTHEM * normals[face, 0] - s * normals[face, 1]
            at[1] = _APOTHEM * normals[face, 1] + s * normals[face, 0]
            at[2] = z
        else:
            while True:
                at[0], at[1] = random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)
                inside = True
                for f in range(6):
                    inside = inside and normals[f, 0] * at[0] + normals[f, 1] * at[1] <= _APOTHEM
                if inside:
                    break
            at[2] = _HALF_LENGTH * normals[face, 2]
        cosine = -(normals[face] @ d)
        share, behind = fresnel(cosine, n)
        if random.random() < share:
            for c in range(3):
                d[c] += 2.0 * cosine * normals[face, c]
        else:
            _bend(d, normals[face], cosine, behind, n)
            for _ in range(_MOST_BOUNCES):
                nearest, exit_face = 1e30, 0
                for f in range(8):
                    towards = normals[f] @ d
                    if towards > 1e-12:
                        reach = (distances[f] - normals[f] @ at) / towards
                        if reach < nearest:
                            nearest, exit_face = reach, f
                for c in range(3):
                    at[c] += nearest * d[c]
                cosine = normals[exit_face] @ d
                share, behind = fresnel(cosine, 1.0 / n)
                if random.random() < share:
                    for c in range(3):
                        d[c] -= 2.0 * cosine * normals[exit_face, c]
                    continue
                for c in range(3):
                    side[c] = -normals[exit_face, c]
                _bend(d, side, cosine, behind, 1.0 / n)
                break
        nu = min(max(came @ d, -1.0), 1.0)
        if nu > _UNDEVIATED:
            kept += 1
            continue
        place = math.sqrt(0.5 - 0.5 * nu)
        counts[min(int(place * (bins - 1) + 0.5), bins - 1)] += 1
    return kept


def phase_of(n: float, rays: int, seed: int) -> tuple[FloatArray, float]:
    """The phase function (PHASE_NODES,) of an index, and the share of rays without deviation."""
    turns = np.arange(6) * np.pi / 3.0
    sides = np.stack([np.cos(turns), np.sin(turns), np.zeros(6)], axis=-1)
    normals = np.concatenate([sides, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    distances = np.array([_APOTHEM] * 6 + [_HALF_LENGTH] * 2)
    areas = np.array([2.0 * _HALF_LENGTH] * 6 + [3.0 * _APOTHEM] * 2)
    counts = np.zeros(PHASE_NODES)
    kept = trace(normals, distances, areas, n, rays, np.random.default_rng(seed), counts)
    edges = (np.arange(PHASE_NODES + 1) - 0.5).clip(0.0, PHASE_NODES - 1.0) / (PHASE_NODES - 1.0)
    phase = counts / np.diff(4.0 * np.pi * edges**2)
    # The sun's disc is wider than two bins.
    padded = np.pad(phase, 2, mode="edge")
    smooth = np.convolve(padded, [0.1, 0.25, 0.3, 0.25, 0.1], mode="valid")
    return smooth, kept / rays


def among_rough_ones(columns: PhaseTable) -> PhaseTable:
    """The columns among crystals without a form, which scatter as Henyey and Greenstein say."""
    nu, g = node_cosines(), columns.mean_cosine()[:, None]
    lobe = (1.0 - g * g) / (4.0 * np.pi * (1.0 + g * g - 2.0 * g * nu) ** 1.5)
    return PhaseTable(_SMOOTH_SHARE * columns.values + (1.0 - _SMOOTH_SHARE) * lobe)


def main() -> None:
    """Trace and write the table."""
    rows = [phase_of(float(n), _RAYS, 20 + number) for number, n in enumerate(ICE)]
    table = PhaseTable([row for row, _ in rows])
    print("mean cosine", table.mean_cosine(), "undeviated", [share for _, share in rows])
    table = among_rough_ones(table)
    np.savez_compressed(
        TARGET, wavelength_nm=WAVELENGTH_NM, phase_per_sr=table.values.astype(np.float32)
    )


if __name__ == "__main__":
    main()
