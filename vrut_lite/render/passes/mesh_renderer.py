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
from vrut_lite.render.passes.specular_filter import LEVEL_ROUGHNESS
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene
from vrut_lite.render.shader_files import SHADERS, Defines, defined, shader_source
from vrut_lite.render.surface_light import SurfaceLightOnGpu

pyrender = import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)
from pyrender.constants import ProgramFlags, RenderFlags  # noqa: E402
from pyrender.shader_program import ShaderProgram, ShaderProgramCache  # noqa: E402

# As mesh.frag binds them; the first units are a material's textures, which pyrender numbers.
_SKY_UNIT, SHADOW_UNIT, _REFLECTION_UNIT, _REFLECTANCE_UNIT, _NEAR_SHADOW_UNIT = 8, 9, 10, 11, 15
_LAYER_UNIFORMS: dict[str, MapName] = {
    "base_color_layer": "base_colour",
    "metallic_roughness_layer": "metallic_roughness",
    "normal_layer": "normal",
    "occlusion_layer": "occlusion",
    "emissive_layer": "emission",
}


@dataclass(frozen=True)
class View:
    """A camera: where the eye is (3,), and matrices (4, 4) that know only where it looks."""

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
        # What cuts the scene's meshes, but neither the ground's disc nor shadows.
        self.section: Section | None = None

    def __del__(self) -> None:
        """Do nothing: pyrender would free GL objects from whatever thread collects garbage."""

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
    ) -> None:
        """Draw meshes of the scene, one after another, with the depth test that is set.

        The `defines` say what else the shader does, as air.py has it.
        """
        GL.glEnable(GL.GL_DEPTH_TEST)
        defines = (*defines, "NEAR_SHADOW") if shadows.near else defines
        shadow_uniforms = _shadow_uniforms(shadows, view)
        _bind_maps(light, shadows, reflection)
        surface_light.bind(scene, light, view.eye_m)
        for placed in placed_in_order:
            primitive = placed.primitive
            cuts = self.section is not None and not placed.is_ground
            cut: Defines = ("SECTION",) if cuts else ()
            self._program_cache.also = (*defines, *cut, *surface_light.defines(placed))
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
            _set_surface(program, primitive.material)
            if placed.light_corner_px is not None:
                program.set_uniform("light_corner_px", placed.light_corner_px.astype(np.float32))
            if surface_light.mirrors(placed):
                program.set_uniform("mirror_eye_m", surface_light.bind_mirror(placed, view.eye_m))
            pose = translation(-view.eye_m) @ placed.world_from_model
            self._bind_and_draw_primitive(primitive, pose, program, RenderFlags.NONE)
            self._reset_active_textures()
            if cuts:
                GL.glDisable(GL.GL_CLIP_DISTANCE0)
        GL.glUseProgram(0)
        GL.glDisable(GL.GL_BLEND)

    def draw_depth(self, scene: PyrenderScene, shadow: Shadow) -> None:
        """Draw the depth of what casts shadows, both sides of every face."""
        GL.glEnable(GL.GL_DEPTH_TEST)
        # What stands between the sun and the map's box casts into it too.
        GL.glEnable(GL.GL_DEPTH_CLAMP)
        self._program_cache.also = ()
        GL.glDepthFunc(GL.GL_LESS)
        GL.glDepthMask(GL.GL_TRUE)
        for placed in scene.placed:
            if placed.is_ground:
                continue
            primitive = placed.primitive
            program = self._get_primitive_program(primitive, RenderFlags.NONE, ProgramFlags.NONE)
            program._bind()
            program.set_uniform("V", np.eye(4))
            program.set_uniform("P", shadow.matrix)
            program.set_uniform("M", translation(-shadow.centre_m) @ placed.world_from_model)
            self._set_cut_out(program, primitive.material)
            self._draw_both_sides(primitive)
            self._reset_active_textures()
        GL.glDisable(GL.GL_DEPTH_CLAMP)
        GL.glUseProgram(0)

    def _set_cut_out(self, program: ShaderProgram, material: Any) -> None:
        """A masked surface casts by its own cut-off, a blended one where alpha exceeds 0.5."""
        cut_offs = {"MASK": float(material.alphaCutoff), "BLEND": 0.5}
        cut_off = cut_offs.get(material.alphaMode, 0.0)
        texture = material.baseColorTexture if cut_off > 0.0 else None
        program.set_uniform("alpha_cutoff", cut_off)
        program.set_uniform("base_alpha", float(material.baseColorFactor[3]))
        program.set_uniform("has_alpha_texture", 0.0 if texture is None else 1.0)
        if texture is not None:
            program.set_uniform("alpha_layer", material.layer_of.get("base_colour", 0))
            self._bind_texture(texture, "alpha_texture", program)

    def _draw_both_sides(self, primitive: Any) -> None:
        GL.glDisable(GL.GL_CULL_FACE)
        GL.glDisable(GL.GL_BLEND)
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


def in_order(
    seen: Iterable[PlacedPrimitive], eye_m: NDArray
) -> tuple[list[PlacedPrimitive], list[PlacedPrimitive]]:
    """Opaque meshes from near to far, which spares hidden fragments, and the others back."""
    by_distance = sorted(seen, key=lambda placed: float(np.linalg.norm(placed.centre_m - eye_m)))
    blended = [placed for placed in by_distance if placed.primitive.is_transparent]
    opaque = [placed for placed in by_distance if not placed.primitive.is_transparent]
    return opaque, blended[::-1]


def _bind_maps(light: Light, shadows: Shadows, reflection: Reflection) -> None:
    light.mirrored.texture.use(location=_SKY_UNIT)
    shadows.scene.texture.use(location=SHADOW_UNIT)
    if shadows.near is not None:
        shadows.near.texture.use(location=_NEAR_SHADOW_UNIT)
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


def _set_surface(program: ShaderProgram, material: Any) -> None:
    cutoff = float(material.alphaCutoff) if material.alphaMode == "MASK" else 0.0
    program.set_uniform("alpha_cutoff", cutoff)
    program.set_uniform("opaque", 0.0 if material.alphaMode == "BLEND" else 1.0)
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
