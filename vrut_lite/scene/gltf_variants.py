"""KHR_materials_variants: other materials of the same meshes, chosen by name."""

import msgspec

from vrut_lite.scene.gltf_schema import Gltf, GltfMesh, Primitive


def variant_names(document: Gltf) -> list[str]:
    """The names of the document's variants, on one line each."""
    return [" ".join(one.name.split()) for one in document.extensions.variants.variants]


def with_variant(document: Gltf, variant: str) -> Gltf:
    """The document with the materials of a variant, by name or counted from 1.

    As it is if it has no such variant; primitives that a variant does not name keep their own.
    """
    names = variant_names(document)
    if variant in names:
        number = names.index(variant)
    elif variant.isdecimal() and 1 <= int(variant) <= len(names):
        number = int(variant) - 1
    else:
        return document
    meshes = [_dressed(mesh, number) for mesh in document.meshes]
    return msgspec.structs.replace(document, meshes=meshes)


def _dressed(mesh: GltfMesh, number: int) -> GltfMesh:
    primitives = [
        msgspec.structs.replace(one, material=_material(one, number)) for one in mesh.primitives
    ]
    return msgspec.structs.replace(mesh, primitives=primitives)


def _material(primitive: Primitive, number: int) -> int | None:
    for mapping in primitive.extensions.variants.mappings:
        if number in mapping.variants:
            return mapping.material
    return primitive.material
