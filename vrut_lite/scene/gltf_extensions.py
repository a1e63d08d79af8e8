"""Supported glTF extensions, and the replacements of others."""

import re
from collections.abc import Iterable

from vrut_lite.scene.gltf_terms import DRAWN_EXTENSIONS
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.scene_file_error import SceneFileError
from vrut_lite.scene.spec_gloss import NAME as SPEC_GLOSS

# The reader honours these.
HONOURED = frozenset(
    {
        "EXT_lights_ies",
        "EXT_mesh_gpu_instancing",
        "EXT_meshopt_compression",
        "EXT_texture_webp",
        "KHR_draco_mesh_compression",
        "KHR_lights_punctual",
        "KHR_mesh_quantization",
        "KHR_meshopt_compression",
        "KHR_texture_basisu",
        "KHR_texture_transform",
        SPEC_GLOSS,
        *DRAWN_EXTENSIONS,
    }
)
# Extensions without an effect on pictures.
_UNSEEN = frozenset({"KHR_xmp", "KHR_xmp_json_ld", "EXT_structural_metadata", "EXT_mesh_features"})
# Extensions about which gltf_notices.py gives a more detailed warning.
_TOLD_BY_NAME = frozenset({"KHR_materials_variants"})
# Replacements of extensions without which a file has a plain reading, even if it requires them.
_INSTEAD = {
    "EXT_lights_image_based": "the sky lights instead",
    "KHR_animation_pointer": "what it moves rests",
    "KHR_audio": "silent",
    "KHR_materials_dispersion": "light of all colours is bent alike",
    "KHR_node_visibility": "everything is shown",
    "OMI_environment_sky": "the hour's sky lights; the file can be its photograph",
    "MSFT_lod": "the finest level is shown",
}
_PLAIN = re.compile(r"(KHR|EXT|ADOBE|MSFT|FB)_(materials?|physics|interactivity)(_|$)")


def check_extensions(
    text: bytes, used: Iterable[str], required: Iterable[str], notices: Notices
) -> None:
    """Tell the extensions of a document (its JSON text) that are not read, with their counts.

    Raises:
        SceneFileError: it requires one that has no plain reading.
    """
    names = dict.fromkeys((*used, *required))
    unread = [name for name in names if name not in HONOURED | _UNSEEN | _TOLD_BY_NAME]
    refused = [name for name in unread if name in set(required) and not _has_plain_reading(name)]
    if refused:
        shown = ", ".join(ascii(name)[1:-1][:60] for name in refused[:4])
        raise SceneFileError(
            f"it requires the glTF extension {shown}, which is not supported; export it "
            "without, or rewrite it with `npx @gltf-transform/cli copy IN.glb OUT.glb`"
        )
    for name in unread:
        instead = _INSTEAD.get(name, "not drawn")
        notices.tell(f"extension {name}", instead, max(_occurrences(text, name), 1))


def _has_plain_reading(name: str) -> bool:
    return name in _INSTEAD or _PLAIN.match(name) is not None


def _occurrences(text: bytes, name: str) -> int:
    """How many objects have this extension: how often its name is a key."""
    return len(re.findall(b'"' + re.escape(name.encode()) + rb'"\s*:', text))
