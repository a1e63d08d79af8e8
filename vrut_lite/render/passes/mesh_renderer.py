"""pyrender's renderer with our shaders: buffers and textures are its, the light is ours.

pyrender keeps vertex buffers, textures and programs in the shared GL context. Its own passes
are not used: they draw into framebuffer 0, clamp to 8 bits and know no sky.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.daylight.scene_content import MapName
from vrut_lite.daylight.section import Section
from vrut_lite.geometry.reflection import DIELECTRIC_F0
from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.light import Light, Reflection, Shadow, Shadows
from vrut_lite.render.passes.draw_order import (
    SOLID_ALPHA,
    alpha_range,
    has_solid_texels,
    is_blended,
)
from vrut_lite.render.passes.specular_filter import LEVEL_ROUGHNESS
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene
from vrut_lite.render.shader_files import SHADERS, Defines, defined, shader_source
from vrut_lite.render.surface_light import SurfaceLightOnGpu
from vrut_lite.render.surface_terms import SurfaceTermsOnGpu, scale_of, term_defines

pyrender = import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)
from pyrender.constants import ProgramFlags, RenderFlags  # noqa: E402
from pyrender.shader_program import ShaderProgram, ShaderProgramCache  # noqa: E402

# As mesh.frag binds them; the first units are a material's textures, which pyrender numbers.
_SKY_UNIT, SHADOW_UNIT, _REFLECTION_UNIT, _REFLECTANCE_UNIT, _NEAR_SHADOW_UNIT = 8, 9, 10, 11, 15
_GLASS_SHADOW_UNIT = 23
_LAYER_UNIFORMS: dict[str, MapName] = {
    "base_color_layer": "base_colour",
    "metallic_roughness_layer": "metallic_roughness",
    "normal_layer": "normal",
    "occlusion_layer": "occlusion",
    "emissive_layer": "emission",
}


@dataclass(frozen=True)
class View:
    """A camera: the eye (3,), and matrices (4, 4) of its orientation alone."""

    eye_m: NDArray[np.float64]
    rotation: NDArray[np.float64]
    projection: NDArray[np.float64]


class _Program(ShaderProgram):
    """A program of our shaders, with pyrender's names defined as GLSL has it."""

    def _load(self, shader_filename: str) -> str:
        return defined(shader_source(Path(shader_filename).name), self.defines)


class _Programs(ShaderProgramCache):
    """Programs by their shaders and defines, pyrender's and `also` ours."""

    also: Defines = ()

    def get_program(
        self,
        vertex_shader: str,
        fragment_shader: str,
        geometry_shader: None = None,
        defines: Mapping[str, int] | None = None,
    ) -> ShaderProgram:
        known = self._program_cache
        all_defines = {**(defines or {}), **dict.fromkeys(self.also, 1)}
        key = (vertex_shader, fragment_shader, *sorted(all_defines.items()))
        if key not in known:
            known[key] = _Program(vertex_shader, fragment_shader, defines=all_defines)
        return known[key]


class MeshRenderer(pyrender.Renderer):  # type: ignore[name-defined]
    """Draws the meshes of a pyrender scene into whatever framebuffer is bound."""

    def __init__(self) -> None:
        super().__init__(1, 1)
        self._program_cache = _Programs(shader_dir=str(SHADERS))
        self._terms = SurfaceTermsOnGpu()
        # What cuts the scene's meshes, but neither the ground's disc nor shadows.
        self.section: Section | None = None

    def __del__(self) -> None:
        """Do nothing: pyrender would free GL objects from whatever thread collects garbage."""

    def delete(self) -> None:
        """Free all that it keeps on the GPU."""
        self._terms.release()
        super().delete()

    def update(self, scene: PyrenderScene) -> None:
        """Bring the scene's buffers and textures to the GPU, and free those that left it."""
        # Rows of 3-channel textures are packed; GL's default would skew odd widths.
        GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
        self._update_context(scene.scene, RenderFlags.NONE)

    def draw(
        self,
        scene: PyrenderScene,
        placed_in_order: Iterable[PlacedPrimitive],
        view: View,
        light: Light,
        shadows: Shadows,
        reflection: Reflection,
        surface_light: SurfaceLightOnGpu,
        defines: Defines,
        blended: bool = False,
    ) -> None:
        """Draw meshes of the scene, one after another, with the depth test that is set.

        `defines`: further features of the shader, as in air.py. Of blended materials the
        solid texels are drawn, or else, if `blended`, the others.
        """
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthMask(GL.GL_FALSE if blended else GL.GL_TRUE)
        defines = (*defines, "NEAR_SHADOW") if shadows.near else defines
        defines = (*defines, "GLASS_SHADOW") if shadows.scene.tint else defines
        shadow_uniforms = _shadow_uniforms(shadows, view)
        _bind_maps(light, shadows, reflection)
        surface_light.bind(scene, light, view.eye_m)
        for placed in placed_in_order:
            primitive = placed.primitive
            cuts = self.section is not None and not placed.is_ground
            own = (
                *(("SECTION",) if cuts else ()),
                *_surface_defines(primitive.material),
                *term_defines(primitive.material, blended),
                *surface_light.defines(placed),
            )
            self._program_cache.also = (*defines, *own)
            program = self._get_primitive_program(
                primitive, RenderFlags.NONE, ProgramFlags.USE_MATERIAL
            )
            program._bind()
            program.set_uniform("V", view.rotation)
            program.set_uniform("P", view.projection)
            for name, value in shadow_uniforms.items():
                program.set_uniform(name, value)
            if cuts:
                program.set_uniform("section", _seen_from(self.section, view.eye_m))
                GL.glEnable(GL.GL_CLIP_DISTANCE0)
            program.set_uniform("reflection_scale", float(reflection.scale))
            program.set_uniform("level_roughness", np.array(LEVEL_ROUGHNESS))
            _set_light(program, light)
            _set_surface(program, primitive, blended)
            if placed.light_corner_px is not None:
                program.set_uniform("light_corner_px", placed.light_corner_px.astype(np.float32))
            if surface_light.mirrors(placed):
                program.set_uniform("mirror_eye_m", surface_light.bind_mirror(placed, view.eye_m))
            pose = translation(-view.eye_m) @ placed.world_from_model
            self._terms.bind(primitive.material, scale_of(placed.world_from_model))
            program.set_uniform("M", pose)
            self._bind_material(program, primitive.material)
            _draw_sides(primitive, blended)
            self._reset_active_textures()
            if cuts:
                GL.glDisable(GL.GL_CLIP_DISTANCE0)
        GL.glUseProgram(0)
        GL.glDisable(GL.GL_BLEND)
        GL.glDepthMask(GL.GL_TRUE)

    def _bind_material(self, program: ShaderProgram, material: Any) -> None:
        for name, texture in _textures(material):
            if texture is not None:
                self._bind_texture(texture, f"material.{name}_texture", program)
        program.set_uniform("material.emissive_factor", material.emissiveFactor)
        program.set_uniform("material.base_color_factor", material.baseColorFactor)
        program.set_uniform("material.metallic_factor", material.metallicFactor)
        program.set_uniform("material.roughness_factor", material.roughnessFactor)

    def draw_depth(self, scene: PyrenderScene, shadow: Shadow) -> None:
        """Draw the depth of shadow casters, both sides of every face."""
        GL.glEnable(GL.GL_DEPTH_TEST)
        # Casters between the sun and the map's box cast into it too.
        GL.glEnable(GL.GL_DEPTH_CLAMP)
        GL.glDepthFunc(GL.GL_LESS)
        GL.glDepthMask(GL.GL_TRUE)
        for placed in scene.placed:
            if placed.casts and has_solid_texels(placed.primitive):
                self._draw_caster(placed, shadow, ())
        GL.glDisable(GL.GL_DEPTH_CLAMP)
        GL.glUseProgram(0)

    def draw_tint(self, scene: PyrenderScene, shadow: Shadow, texels: int) -> None:
        """Multiply what blended surfaces before the bound depth leave of sunlight.

        Alpha becomes the depth of the one that is nearest to the sun.
        """
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glEnable(GL.GL_DEPTH_CLAMP)
        GL.glDepthFunc(GL.GL_LEQUAL)
        GL.glDepthMask(GL.GL_FALSE)
        GL.glBlendEquationSeparate(GL.GL_FUNC_ADD, GL.GL_MIN)
        GL.glBlendFuncSeparate(GL.GL_ZERO, GL.GL_SRC_COLOR, GL.GL_ONE, GL.GL_ONE)
        for placed in scene.placed:
            material = placed.primitive.material
            if is_blended(material):
                glass = ("GLASS",) if material.terms.transmits else ()
                self._draw_caster(placed, shadow, ("TINT", *glass), float(texels))
        GL.glBlendEquation(GL.GL_FUNC_ADD)
        GL.glDisable(GL.GL_BLEND)
        GL.glDepthMask(GL.GL_TRUE)
        GL.glDepthFunc(GL.GL_LESS)
        GL.glDisable(GL.GL_DEPTH_CLAMP)
        GL.glUseProgram(0)

    def _draw_caster(
        self, placed: PlacedPrimitive, shadow: Shadow, defines: Defines, texels: float = 0.0
    ) -> None:
        primitive = placed.primitive
        material = primitive.material
        has_map = ("HAS_TRANSMISSION_TEX",) if "transmission" in material.further else ()
        self._program_cache.also = (*_surface_defines(material), *has_map, *defines)
        program = self._get_primitive_program(primitive, RenderFlags.NONE, ProgramFlags.NONE)
        program._bind()
        program.set_uniform("V", np.eye(4))
        program.set_uniform("P", shadow.matrix)
        program.set_uniform("M", translation(-shadow.centre_m) @ placed.world_from_model)
        if material.terms.transmits:
            self._terms.bind(material, scale_of(placed.world_from_model))
        if defines:
            program.set_uniform("blended", float(material.alphaMode == "BLEND"))
            if "GLASS" in defines:
                program.set_uniform("map_texels", texels)
                program.set_uniform("base_tint", np.asarray(material.baseColorFactor[:3]))
            GL.glEnable(GL.GL_BLEND)
        else:
            GL.glDisable(GL.GL_BLEND)
        self._set_cut_out(program, material)
        GL.glDisable(GL.GL_CULL_FACE)
        _draw_triangles(primitive)
        self._reset_active_textures()

    def _set_cut_out(self, program: ShaderProgram, material: Any) -> None:
        """A masked surface casts by its own cut-off, a blended one where nothing shows through."""
        cut_offs = {"MASK": float(material.alphaCutoff), "BLEND": SOLID_ALPHA}
        cut_off = cut_offs.get(material.alphaMode, 0.0)
        looked_up = cut_off > 0.0 or material.terms.transmits
        texture = material.baseColorTexture if looked_up else None
        program.set_uniform("alpha_cutoff", cut_off)
        program.set_uniform("base_alpha", float(material.baseColorFactor[3]))
        program.set_uniform("has_alpha_texture", 0.0 if texture is None else 1.0)
        if texture is not None:
            program.set_uniform("alpha_layer", material.layer_of.get("base_colour", 0))
            self._bind_texture(texture, "alpha_texture", program)


def _surface_defines(material: Any) -> Defines:
    """What programs are compiled with by what a material is."""
    return ("CUT_OUT",) if material.is_cut_out else ()


def _textures(material: Any) -> Iterable[tuple[str, Any]]:
    """The textures that a material may have, by the shader's names."""
    yield "normal", material.normalTexture
    yield "occlusion", material.occlusionTexture
    yield "emissive", material.emissiveTexture
    yield "base_color", material.baseColorTexture
    yield "metallic_roughness", material.metallicRoughnessTexture


def _draw_sides(primitive: Any, blended: bool) -> None:
    """Draw the sides of a mesh that show: of a blended one the backs before the fronts."""
    GL.glPolygonMode(GL.GL_FRONT_AND_BACK, GL.GL_FILL)
    if blended:
        GL.glEnable(GL.GL_BLEND)
        if primitive.material.terms.transmits:
            # What is behind times a colour that the shader says.
            GL.glBlendFunc(GL.GL_ONE, GL.GL_SRC1_COLOR)
        else:
            GL.glBlendFunc(GL.GL_SRC_ALPHA, GL.GL_ONE_MINUS_SRC_ALPHA)
    else:
        GL.glDisable(GL.GL_BLEND)
    if primitive.material.doubleSided and blended:
        GL.glEnable(GL.GL_CULL_FACE)
        for hidden in (GL.GL_FRONT, GL.GL_BACK):
            GL.glCullFace(hidden)
            _draw_triangles(primitive)
        return
    if primitive.material.doubleSided:
        GL.glDisable(GL.GL_CULL_FACE)
    else:
        GL.glEnable(GL.GL_CULL_FACE)
        GL.glCullFace(GL.GL_BACK)
    _draw_triangles(primitive)


def _draw_triangles(primitive: Any) -> None:
    primitive._bind()
    if primitive.indices is not None:
        GL.glDrawElements(primitive.mode, primitive.indices.size, GL.GL_UNSIGNED_INT, None)
    else:
        GL.glDrawArrays(primitive.mode, 0, len(primitive.positions))
    primitive._unbind()


def shadow_from_eye(shadow: Shadow, view: View) -> NDArray[np.float64]:
    """Matrix (4, 4) of positions relative to the eye into the shadow map's clip space."""
    return np.asarray(shadow.matrix @ translation(view.eye_m - shadow.centre_m))


def _shadow_uniforms(shadows: Shadows, view: View) -> dict[str, Any]:
    uniforms: dict[str, Any] = {}
    for name, shadow in (("shadow", shadows.scene), ("near_shadow", shadows.near)):
        if shadow is not None:
            uniforms[f"{name}_matrix"] = shadow_from_eye(shadow, view)
            uniforms[f"{name}_texel_m"] = float(shadow.texel_m)
    return uniforms


def translation(offset_m: NDArray) -> NDArray[np.float64]:
    """Matrix (4, 4) that moves by an offset (3,)."""
    matrix = np.eye(4)
    matrix[:3, 3] = offset_m
    return matrix


def _bind_maps(light: Light, shadows: Shadows, reflection: Reflection) -> None:
    light.mirrored.texture.use(location=_SKY_UNIT)
    shadows.scene.texture.use(location=SHADOW_UNIT)
    if shadows.near is not None:
        shadows.near.texture.use(location=_NEAR_SHADOW_UNIT)
    nearest = shadows.near or shadows.scene
    if nearest.tint is not None:
        nearest.tint.use(location=_GLASS_SHADOW_UNIT)
    reflection.texture.use(location=_REFLECTION_UNIT)
    reflection.reflectance.use(location=_REFLECTANCE_UNIT)


def _set_light(program: ShaderProgram, light: Light) -> None:
    program.set_uniform("sun_direction", np.asarray(light.sun_direction, dtype=float))
    program.set_uniform("sun_irradiance", np.asarray(light.sun_irradiance, dtype=float))
    program.set_uniform("sky_scale", float(light.mirrored.scale))
    # pyrender's set_uniform knows no arrays.
    place = GL.glGetUniformLocation(program._program_id, "irradiance_sh")
    harmonics = np.ascontiguousarray(light.irradiance_sh, dtype=np.float32)
    GL.glUniform3fv(place, len(harmonics), harmonics)


def _set_surface(program: ShaderProgram, primitive: Any, blended: bool) -> None:
    material = primitive.material
    first, end = alpha_range(primitive, blended)
    program.set_uniform("alpha_cutoff", first)
    program.set_uniform("alpha_end", end)
    program.set_uniform("opaque", 0.0 if blended else 1.0)
    for name, map_name in _LAYER_UNIFORMS.items():
        program.set_uniform(name, material.layer_of.get(map_name, 0))
    program.set_uniform("normal_scale", float(material.normal_scale))
    program.set_uniform("occlusion_strength", float(material.occlusion_strength))
    program.set_uniform("dielectric_f0", 0.0 if material.matte else DIELECTRIC_F0)


def _seen_from(section: Section | None, eye_m: NDArray[np.float64]) -> NDArray[np.float32]:
    """The plane (4,) in positions that are relative to an eye."""
    assert section is not None
    distance_m = section.offset_m - float(np.dot(section.normal, eye_m))
    return np.array([*section.normal, distance_m], np.float32)
