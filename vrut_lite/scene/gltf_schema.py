"""The part of glTF 2.0 that is read, as types: msgspec refuses all else."""

from typing import Annotated, Literal

from msgspec import Meta, Raw, Struct, field

Index = Annotated[int, Meta(ge=0, le=2**31)]
Size = Annotated[int, Meta(ge=0, le=2**40)]
Vector3 = tuple[float, float, float]
Vector4 = tuple[float, float, float, float]


class GltfPart(Struct, frozen=True, rename="camel"):
    """Base of all parts: camel case in the file; unknown fields are ignored."""


class Asset(GltfPart, frozen=True):
    """The file's metadata, of which the version is read."""

    version: str


class MeshoptBuffer(GltfPart, frozen=True):
    """A buffer that may lack its bytes, since all its views are packed elsewhere."""

    fallback: bool = False


class BufferExtensions(GltfPart, frozen=True):
    """The extensions of a buffer that are honoured; both names mean the same."""

    ext: MeshoptBuffer | None = field(default=None, name="EXT_meshopt_compression")
    khr: MeshoptBuffer | None = field(default=None, name="KHR_meshopt_compression")


class Buffer(GltfPart, frozen=True):
    """Raw bytes; without a URI they are the GLB's binary chunk."""

    byte_length: Size
    uri: str | None = None
    extensions: BufferExtensions = BufferExtensions()

    @property
    def may_be_empty(self) -> bool:
        """Whether it is a placeholder for bytes that are packed elsewhere."""
        packed = self.extensions.ext or self.extensions.khr
        return packed is not None and packed.fallback


class MeshoptView(GltfPart, frozen=True):
    """Where a view's bytes are packed, and how."""

    buffer: Index
    byte_length: Size
    byte_stride: Annotated[int, Meta(ge=1, le=256)]
    count: Annotated[int, Meta(ge=1, le=2**31)]
    mode: Literal["ATTRIBUTES", "TRIANGLES", "INDICES"]
    filter: Literal["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"] = "NONE"
    byte_offset: Size = 0


class BufferViewExtensions(GltfPart, frozen=True):
    """The extensions of a buffer view that are honoured; both names mean the same."""

    ext: MeshoptView | None = field(default=None, name="EXT_meshopt_compression")
    khr: MeshoptView | None = field(default=None, name="KHR_meshopt_compression")


class BufferView(GltfPart, frozen=True):
    """A slice of a buffer."""

    buffer: Index
    byte_length: Size
    byte_offset: Size = 0
    byte_stride: Annotated[int, Meta(ge=1, le=252)] | None = None
    extensions: BufferViewExtensions = BufferViewExtensions()

    @property
    def packed(self) -> MeshoptView | None:
        """Where its bytes are packed."""
        return self.extensions.ext or self.extensions.khr


class SparseIndices(GltfPart, frozen=True):
    """Which elements a sparse accessor replaces."""

    buffer_view: Index
    component_type: Literal[5121, 5123, 5125]
    byte_offset: Size = 0


class SparseValues(GltfPart, frozen=True):
    """The elements that replace them."""

    buffer_view: Index
    byte_offset: Size = 0


class Sparse(GltfPart, frozen=True):
    """A few elements that differ from the rest."""

    count: Annotated[int, Meta(ge=1, le=2**31)]
    indices: SparseIndices
    values: SparseValues


class Accessor(GltfPart, frozen=True):
    """A typed array inside a buffer view; without a view it is zero."""

    component_type: Literal[5120, 5121, 5122, 5123, 5125, 5126]
    count: Annotated[int, Meta(ge=1, le=2**31)]
    type: Literal["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"]
    buffer_view: Index | None = None
    byte_offset: Size = 0
    normalized: bool = False
    sparse: Sparse | None = None


class Image(GltfPart, frozen=True):
    """An encoded picture, in a file, a data URI or a buffer view."""

    uri: str | None = None
    buffer_view: Index | None = None


class OtherSource(GltfPart, frozen=True):
    """EXT_texture_webp and KHR_texture_basisu: the image to take instead."""

    source: Index


class TextureExtensions(GltfPart, frozen=True):
    """The extensions of a texture that are honoured."""

    webp: OtherSource | None = field(default=None, name="EXT_texture_webp")
    basis: OtherSource | None = field(default=None, name="KHR_texture_basisu")


class GltfSampler(GltfPart, frozen=True):
    """How texels are looked up beyond the image's edges and between each other; OpenGL's codes."""

    wrap_s: int = 10497
    wrap_t: int = 10497
    mag_filter: int | None = None


class Texture(GltfPart, frozen=True):
    """An image as it is sampled; a texture without a source is empty."""

    source: Index | None = None
    sampler: Index | None = None
    extensions: TextureExtensions = TextureExtensions()


class TextureTransform(GltfPart, frozen=True):
    """KHR_texture_transform: texture coordinates are scaled, turned and moved, in this order."""

    offset: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    scale: tuple[float, float] = (1.0, 1.0)
    tex_coord: Index | None = None


class TextureInfoExtensions(GltfPart, frozen=True):
    """The extensions of a texture reference that are honoured."""

    transform: TextureTransform | None = field(default=None, name="KHR_texture_transform")


class TextureInfo(GltfPart, frozen=True):
    """Which texture, through which set of coordinates.

    A normal map may have a scale, an occlusion map a strength.
    """

    index: Index
    tex_coord: Index = 0
    scale: float = 1.0
    strength: float = 1.0
    extensions: TextureInfoExtensions = TextureInfoExtensions()


class MetallicRoughness(GltfPart, frozen=True):
    """The core material model; the defaults are glTF's."""

    base_color_factor: Vector4 = (1.0, 1.0, 1.0, 1.0)
    metallic_factor: float = 1.0
    roughness_factor: float = 1.0
    base_color_texture: TextureInfo | None = None
    metallic_roughness_texture: TextureInfo | None = None


class GltfMaterial(GltfPart, frozen=True):
    """A surface; the defaults are glTF's."""

    name: str = ""
    pbr_metallic_roughness: MetallicRoughness = MetallicRoughness()
    normal_texture: TextureInfo | None = None
    occlusion_texture: TextureInfo | None = None
    emissive_texture: TextureInfo | None = None
    emissive_factor: Vector3 = (0.0, 0.0, 0.0)
    alpha_mode: Literal["OPAQUE", "MASK", "BLEND"] = "OPAQUE"
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    # JSON that gltf_terms.py reads.
    extensions: Raw = Raw(b"{}")


class DracoMesh(GltfPart, frozen=True):
    """KHR_draco_mesh_compression: the packed bytes, and Draco's ids of the attributes."""

    buffer_view: Index
    attributes: dict[str, Index]


class VariantMapping(GltfPart, frozen=True):
    """The material that some variants give a primitive."""

    material: Index
    variants: list[Index]


class VariantMappings(GltfPart, frozen=True):
    """KHR_materials_variants of a primitive."""

    mappings: list[VariantMapping] = []


class PrimitiveExtensions(GltfPart, frozen=True):
    """The extensions of a primitive that are honoured."""

    draco: DracoMesh | None = field(default=None, name="KHR_draco_mesh_compression")
    variants: VariantMappings = field(
        default_factory=VariantMappings, name="KHR_materials_variants"
    )


class Primitive(GltfPart, frozen=True):
    """Triangles (or points or lines, which are passed over) of one material."""

    attributes: dict[str, Index]
    extensions: PrimitiveExtensions = PrimitiveExtensions()
    indices: Index | None = None
    material: Index | None = None
    targets: list[dict[str, Index]] = []
    mode: Annotated[int, Meta(ge=0, le=6)] = 4


class GltfMesh(GltfPart, frozen=True):
    """Primitives that move together."""

    primitives: list[Primitive]
    name: str = ""
    weights: list[float] = []


class Instancing(GltfPart, frozen=True):
    """EXT_mesh_gpu_instancing: accessors of translations, rotations and scales."""

    attributes: dict[str, Index]


class LampIndex(GltfPart, frozen=True):
    """KHR_lights_punctual: the lamp that a node carries."""

    light: Index


class IesInstance(GltfPart, frozen=True):
    """EXT_lights_ies: the luminaire that a node carries."""

    light: Index
    multiplier: float = 1.0
    color: Vector3 = (1.0, 1.0, 1.0)


class NodeExtensions(GltfPart, frozen=True):
    """The extensions of a node that are honoured."""

    instancing: Instancing | None = field(default=None, name="EXT_mesh_gpu_instancing")
    lamp: LampIndex | None = field(default=None, name="KHR_lights_punctual")
    ies: IesInstance | None = field(default=None, name="EXT_lights_ies")


class Node(GltfPart, frozen=True):
    """A node of the tree; `matrix` is column-major and excludes the other three."""

    name: str = ""
    children: list[Index] = []
    mesh: Index | None = None
    skin: Index | None = None
    camera: Index | None = None
    matrix: Annotated[list[float], Meta(min_length=16, max_length=16)] | None = None
    translation: Vector3 = (0.0, 0.0, 0.0)
    rotation: Vector4 = (0.0, 0.0, 0.0, 1.0)
    scale: Vector3 = (1.0, 1.0, 1.0)
    weights: list[float] = []
    extensions: NodeExtensions = NodeExtensions()


class Spot(GltfPart, frozen=True):
    """The cone of a spot, radians from its axis."""

    inner_cone_angle: Annotated[float, Meta(ge=0.0)] = 0.0
    outer_cone_angle: Annotated[float, Meta(gt=0.0, le=1.5708)] = 0.7853981633974483


class Lamp(GltfPart, frozen=True):
    """KHR_lights_punctual: candela, or lux of a directional light."""

    type: Literal["directional", "point", "spot"]
    name: str = ""
    color: Vector3 = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    spot: Spot = Spot()


class GltfLampList(GltfPart, frozen=True):
    """The lamps of the document."""

    lights: list[Lamp] = []


class IesProfile(GltfPart, frozen=True):
    """EXT_lights_ies: an IES file."""

    uri: str | None = None
    buffer_view: Index | None = None
    name: str = ""


class IesProfiles(GltfPart, frozen=True):
    """The luminaires of the document."""

    lights: list[IesProfile] = []


class Variant(GltfPart, frozen=True):
    """KHR_materials_variants: another look of the scene."""

    name: str = ""


class Variants(GltfPart, frozen=True):
    """The variants of the document."""

    variants: list[Variant] = []


class GltfExtensions(GltfPart, frozen=True):
    """The extensions of the document that are honoured."""

    variants: Variants = field(default_factory=Variants, name="KHR_materials_variants")
    punctual: GltfLampList = field(default_factory=GltfLampList, name="KHR_lights_punctual")
    ies: IesProfiles = field(default_factory=IesProfiles, name="EXT_lights_ies")


class Perspective(GltfPart, frozen=True):
    """A pinhole; the angle is vertical, in radians."""

    yfov: Annotated[float, Meta(gt=0.0, lt=3.1415)]


class Camera(GltfPart, frozen=True):
    """A camera; an orthographic one has no `perspective` and is passed over."""

    name: str = ""
    perspective: Perspective | None = None


class Scene(GltfPart, frozen=True):
    """The roots of one tree of nodes."""

    nodes: list[Index] = []


class Skin(GltfPart, frozen=True):
    """Joints that bend a mesh."""

    joints: Annotated[list[Index], Meta(min_length=1)]
    inverse_bind_matrices: Index | None = None


class AnimationTarget(GltfPart, frozen=True):
    """Which part of which node moves; other paths than a node's belong to extensions."""

    path: str
    node: Index | None = None


class AnimationChannel(GltfPart, frozen=True):
    """A sampler that moves a target."""

    sampler: Index
    target: AnimationTarget


class AnimationSampler(GltfPart, frozen=True):
    """Keys: accessors of times and of values."""

    input: Index
    output: Index
    interpolation: Literal["LINEAR", "STEP", "CUBICSPLINE"] = "LINEAR"


class Animation(GltfPart, frozen=True):
    """Movements of nodes over time."""

    name: str = ""
    channels: list[AnimationChannel] = []
    samplers: list[AnimationSampler] = []


class Gltf(GltfPart, frozen=True):
    """The whole document."""

    asset: Asset
    extensions_used: list[str] = []
    extensions_required: list[str] = []
    extensions: GltfExtensions = GltfExtensions()
    buffers: list[Buffer] = []
    buffer_views: list[BufferView] = []
    accessors: list[Accessor] = []
    images: list[Image] = []
    textures: list[Texture] = []
    samplers: list[GltfSampler] = []
    materials: list[GltfMaterial] = []
    meshes: list[GltfMesh] = []
    nodes: list[Node] = []
    cameras: list[Camera] = []
    scenes: list[Scene] = []
    animations: list[Animation] = []
    skins: list[Skin] = []
    scene: Index | None = None
