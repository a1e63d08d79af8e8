"""Materials that a project names as glass, for pictures: one pane that lets as much through."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from vrut_lite.messages.glazing import IOR, Glazing, clear_at_right_angles
from vrut_lite.messages.surface_terms import SurfaceTerms
from vrut_lite.scene.materials import SurfaceMaterial
from vrut_lite.scene.mesh import TriangleMesh
from vrut_lite.scene.placed import PlacedMesh
from vrut_lite.scene.scene_file_error import SceneFileError


def glazed(
    placed: tuple[PlacedMesh, ...], glazing: Mapping[str, Glazing]
) -> tuple[PlacedMesh, ...]:
    """Placed meshes whose materials of these names are smooth glass; shared meshes stay shared.

    Raises:
        SceneFileError: no mesh has a material of a name.
    """
    names = {place.mesh.material.name or "" for place in placed}
    if unknown := sorted(set(glazing) - names):
        known = ", ".join(sorted(names))
        raise SceneFileError(f"glazing: the scene has no material '{unknown[0]}'; it has {known}")
    materials: dict[int, SurfaceMaterial] = {}
    meshes: dict[int, TriangleMesh] = {}
    found = []
    for place in placed:
        mesh, old = place.mesh, place.mesh.material
        if old.name is not None and old.name in glazing:
            if id(old) not in materials:
                materials[id(old)] = _pane(old.name, glazing[old.name])
            if id(mesh) not in meshes:
                meshes[id(mesh)] = replace(mesh, material=materials[id(old)])
            place = replace(place, mesh=meshes[id(mesh)])
        found.append(place)
    return tuple(found)


def _pane(name: str, glass: Glazing) -> SurfaceMaterial:
    tint = glass.transmittance / clear_at_right_angles(1) * np.asarray(glass.colour)
    return SurfaceMaterial(
        name=name,
        baseColorFactor=np.append(tint, 1.0),
        metallicFactor=0.0,
        roughnessFactor=0.0,
        doubleSided=True,
        terms=SurfaceTerms(ior=IOR, transmission=1.0),
    )
