"""Single rays against an opened scene, on the CPU in double precision."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vrut_lite.atmosphere.planet import GROUND_RADIUS_M
from vrut_lite.frame_part import GROUND, Hit
from vrut_lite.messages.ground_disc import fall_m
from vrut_lite.messages.scene import SceneOpened

# A ray starts this share of the scene's size off its surface.
_CLEARANCE = 1e-6
# Largest distance of a point that counts as on a surface.
_TOUCHING = 1e-5


class SceneRays:
    """The triangles of a scene and its ground; cut-out textures are ignored."""

    def __init__(self, scene: SceneOpened):
        geometry, materials = scene.geometry, scene.materials.all()
        meshes = geometry.part_mesh.values
        triangles = [geometry.world_triangles(part) for part in range(len(meshes))]
        self._ends = np.cumsum([len(t) for t in triangles])
        self._materials = [materials[geometry.mesh(mesh).material].name for mesh in meshes]
        self._corner = np.concatenate([t[:, 0] for t in triangles])
        self._edge_1 = np.concatenate([t[:, 1] - t[:, 0] for t in triangles])
        self._edge_2 = np.concatenate([t[:, 2] - t[:, 0] for t in triangles])
        self._ground = scene.ground
        size_m = float(np.linalg.norm(np.subtract(scene.upper_m, scene.lower_m)))
        self._clearance_m = _CLEARANCE * max(size_m, 1e-6)
        self._touching_m = _TOUCHING * max(size_m, 1e-6)

    def first_hit(self, eye_m: ArrayLike, direction: ArrayLike) -> Hit | None:
        """The nearest hit of a ray from `eye_m` (3,) along a unit direction; None for the sky."""
        eye, ray = np.asarray(eye_m, dtype=float), np.asarray(direction, dtype=float)
        distances_m = self._distances_m(eye, ray)
        nearest = int(np.argmin(distances_m)) if distances_m.size else -1
        distance_m = distances_m[nearest] if distances_m.size else np.inf
        ground_m = self._ground_distance_m(eye, ray)
        if not np.isfinite(min(distance_m, ground_m)):
            return None
        if ground_m < distance_m:
            return Hit(eye + ground_m * ray, np.array([0.0, 1.0, 0.0]), "ground", GROUND, 0)
        normal = np.cross(self._edge_1[nearest], self._edge_2[nearest])
        normal /= np.linalg.norm(normal)
        part = int(np.searchsorted(self._ends, nearest, side="right"))
        triangle = nearest - (int(self._ends[part - 1]) if part else 0)
        towards_eye = normal if normal @ ray < 0.0 else -normal
        point = eye + distance_m * ray
        return Hit(point, towards_eye, self._materials[part], part, triangle)

    def surface_at(self, point_m: ArrayLike, normal: ArrayLike) -> Hit | None:
        """The surface at a point (3,), on the side of the given normal."""
        point, n = np.asarray(point_m, dtype=float), np.asarray(normal, dtype=float)
        hit = self.first_hit(point + self._touching_m * n, -n)
        if hit is None or np.linalg.norm(hit.point_m - point) > self._touching_m:
            return None
        return hit

    def is_free(
        self,
        point_m: ArrayLike,
        normal: ArrayLike,
        direction: ArrayLike,
        reach_m: float = np.inf,
    ) -> bool:
        """Whether a ray from a point on a surface is free.

        `reach_m` away, or infinitely far. The ground casts no shadow, since no light comes from
        below it.
        """
        start = np.asarray(point_m, dtype=float) + self._clearance_m * np.asarray(normal)
        distances_m = self._distances_m(start, np.asarray(direction, dtype=float))
        return not np.any(distances_m < reach_m)

    def _distances_m(self, eye: NDArray, ray: NDArray) -> NDArray[np.float64]:
        """Along the ray to each triangle (F,), infinite where it misses.

        Moeller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection".
        """
        p = np.cross(ray, self._edge_2)
        determinant = np.einsum("fi,fi->f", self._edge_1, p)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = eye - self._corner
            u = np.einsum("fi,fi->f", t, p) / determinant
            q = np.cross(t, self._edge_1)
            v = q @ ray / determinant
            distance = np.einsum("fi,fi->f", self._edge_2, q) / determinant
            hit = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance > 0.0)
        return np.where(hit, distance, np.inf)

    def _ground_distance_m(self, eye: NDArray, ray: NDArray) -> float:
        if self._ground is None:
            return float(np.inf)
        # The ground bends: height over it is a t^2 + 2 b t + c along the ray.
        start, along = eye[[0, 2]] - self._ground.centre_xz_m, ray[[0, 2]]
        c = float(eye[1] - self._ground.height_m + fall_m(np.linalg.norm(start)))
        b = 0.5 * float(ray[1] + start @ along / GROUND_RADIUS_M)
        squared = b * b - float(fall_m(np.linalg.norm(along))) * c
        if c <= 0.0 or b >= 0.0 or squared < 0.0:
            return float(np.inf)
        distance_m = c / (np.sqrt(squared) - b)
        inside = np.linalg.norm(start + distance_m * along) <= self._ground.radius_m
        return float(distance_m) if inside else float(np.inf)
