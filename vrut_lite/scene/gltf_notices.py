"""Tells what a glTF file has and its scene does not show."""

from collections.abc import Sequence

from vrut_lite.scene.gltf_file import GltfFile, item_at
from vrut_lite.scene.gltf_points_and_lines import TOLD_STROKES
from vrut_lite.scene.gltf_schema import GltfMesh, Node, Primitive
from vrut_lite.scene.gltf_terms import averaged_maps
from vrut_lite.scene.gltf_variants import variant_names
from vrut_lite.scene.uv_layers import layers_of, texture_infos

_TRIANGLES = 4


def tell_unread(file: GltfFile, nodes: Sequence[Node]) -> None:
    """Tell what the placed nodes have that is not drawn, and what no node of the scene places."""
    document, notices = file.document, file.notices
    meshes = {node.mesh for node in nodes if node.mesh is not None}
    for number in meshes:
        _tell_mesh(file, item_at(document.meshes, number, "mesh"))
    variants = variant_names(document)
    if variants and not file.variant:
        shown = "the default materials are shown (--variant NAME, or Variant in the Scene panel)"
        notices.tell(f"material variants {', '.join(variants)}", shown)
    others = len(document.scenes) - 1
    notices.tell("scene beside the default one", "not drawn", max(others, 0))


def _tell_mesh(file: GltfFile, mesh: GltfMesh) -> None:
    notices = file.notices
    unfilled = [primitive for primitive in mesh.primitives if primitive.mode < _TRIANGLES]
    notices.tell("points or lines", TOLD_STROKES, len(unfilled))
    for primitive in mesh.primitives:
        _tell_maps(file, primitive)


def _tell_maps(file: GltfFile, primitive: Primitive) -> None:
    """Maps of which the mean is taken, and those that lack their texture coordinates."""
    if primitive.material is None or primitive.mode < _TRIANGLES:
        return
    source = item_at(file.document.materials, primitive.material, "material")
    for name in averaged_maps(source):
        instead = "left out" if name == "clearcoatNormalTexture" else "its mean is taken"
        file.notices.tell(name, instead)
    layers, numbers = layers_of(source)
    left_out = [name for name in texture_infos(source) if name not in numbers]
    for name in left_out:
        file.notices.tell(f"{name} on a third set of texture coordinates", "left out")
    for layer in layers:
        if layer.attribute not in primitive.attributes:
            file.notices.tell(f"textures without their {layer.attribute}", "left out")
