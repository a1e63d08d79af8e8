"""Buffer views packed by meshoptimizer (glTF extensions EXT_ and KHR_meshopt_compression)."""

from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.gltf_schema import MeshoptView
from vrut_lite.scene.scene_file_error import SceneFileError

# The codecs pack at most 64 bytes into one: an unchanging byte of 16 vertices takes 2 bits.
_MOST_BYTES_PER_BYTE, _MOST_BASE_BYTES = 64, 2**16
_MISSING = (
    "its buffers are packed by meshoptimizer, and the Python package meshopt is not installed: "
    "`pip install 'vrut-lite[formats]'`, or unpack it with `npx @gltf-transform/cli copy IN.glb "
    "OUT.glb`"
)


def admit_meshopt(view: MeshoptView, budget: SceneBudget) -> None:
    """Count the declared size of an unpacked view before anything is unpacked.

    Raises:
        SceneFileError: it is more than the packed bytes can hold, or exceeds the budget.
    """
    size = view.count * view.byte_stride
    if size > _MOST_BASE_BYTES + _MOST_BYTES_PER_BYTE * view.byte_length:
        raise SceneFileError(
            f"a packed buffer view declares {size} bytes in {view.byte_length}, above the limit of "
            f"{_MOST_BYTES_PER_BYTE} for each; export it again"
        )
    budget.take(size, "a packed buffer view")
    # Unpacked bytes count as bytes of the file, so that as many may be read.
    budget.find(size)


def unpack_meshopt(packed: memoryview, view: MeshoptView) -> bytes:
    """The bytes of a view.

    Raises:
        SceneFileError: they are damaged, or the package that unpacks them is missing.
    """
    try:
        import meshopt
    except ImportError as fault:
        raise SceneFileError(_MISSING) from fault
    try:
        rows = meshopt.decode_gltf_buffer(
            bytes(packed), view.count, view.byte_stride, view.mode, view.filter
        )
    except (ValueError, RuntimeError, TypeError) as fault:
        raise SceneFileError(
            f"a packed buffer view is damaged ({fault}); export it again"
        ) from fault
    unpacked = rows.tobytes()
    if len(unpacked) != view.count * view.byte_stride:
        raise SceneFileError("a packed buffer view has another size than declared; export it again")
    return unpacked
