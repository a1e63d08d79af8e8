"""pyrender's renderer with our shaders: buffers and textures are its, the light is ours.

pyrender keeps vertex buffers, textures and programs in the shared GL context. Its own passes
are not used: they draw into framebuffer 0, clamp to 8 bits and know no sky.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.light import Light
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene

pyrender = import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)
from pyrender.constants import ProgramFlags, RenderFlags  # noqa: E402
from pyrender.shader_program import ShaderProgram, ShaderProgramCache  # noqa: E402

SHADERS = Path(__file__).parent / "shaders"
# As mesh.frag binds them; the first units are a material's textures, which pyrender numbers.
_SKY_UNIT, _SHADOW_UNIT = 8, 9
# Glass, plastic, stone: glTF 2.0, appendix B.2.
DIELECTRIC_F0 = 0.04
_LAYER_UNIFORMS = {
    "base_color_layer": "baseColorTexture",
    "metallic_roughness_layer": "metallicRoughnessTexture",
    "normal_layer": "normalTexture",
    "occlusion_layer": "occlusionTexture",
    "emissive_layer": "emissiveTexture",
}


@dataclass(frozen=True)
class View:
    """A camera: where the eye is (3,), and matrices (4, 4) that know only where it looks."""

    eye_m: NDArray[np.float64]
    rotation: NDArray[np.float64]
    projection: NDArray[np.float64]


class MeshRenderer(pyrender.Renderer):  # type: ignore[name-defined]
    """Draws the meshes of a pyrender scene into whatever framebuffer is bound."""

    def __init__(self) -> None:
        super().__init__(1, 1)
        self._program_cache = ShaderProgramCache(shader_dir=str(SHADERS))

    def __del__(self) -> None:
        """Do nothing: pyrender would free GL objects from whatever thread collects garbage."""

    def update(self, scene: PyrenderScene) -> None:
        """Bring the scene's buffers and textures to the GPU, and free those that left it."""
        # Rows of 3-channel textures are packed; GL's default would skew odd widths.
        GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
        self._update_context(scene.scene, RenderFlags.NONE)

    def draw(self, scene: PyrenderScene, view: View, light: Light) -> None:
        """Draw all meshes with the depth test that is set: opaque first, near to far."""
        GL.glEnable(GL.GL_DEPTH_TEST)
        shadow_matrix = light.shadow_matrix @ translation(view.eye_m - scene.centre_m)
        for placed, primitive in _from_near_to_far(scene, view.eye_m):
            program = self._get_primitive_program(
                primitive, RenderFlags.NONE, ProgramFlags.USE_MATERIAL
            )
            program._bind()
            program.set_uniform("V", view.rotation)
            program.set_uniform("P", view.projection)
            program.set_uniform("shadow_matrix", shadow_matrix)
            self._set_light(program, light)
            _set_surface(program, primitive.material)
            pose = translation(-view.eye_m) @ placed.world_from_model
            self._bind_and_draw_primitive(primitive, pose, program, RenderFlags.NONE)
            self._reset_active_textures()
        GL.glUseProgram(0)
        GL.glDisable(GL.GL_BLEND)

    def draw_depth(self, scene: PyrenderScene, clip_from_centre: NDArray) -> None:
        """Draw the depth of what casts shadows, both sides of every face.

        The matrix (4, 4) takes positions that count from the scene's centre.
        """
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LESS)
        GL.glDepthMask(GL.GL_TRUE)
        for placed in scene.placed:
            if not placed.casts_shadow:
                continue
            primitive = placed.primitive
            program = self._get_primitive_program(primitive, RenderFlags.NONE, ProgramFlags.NONE)
            program._bind()
            program.set_uniform("V", np.eye(4))
            program.set_uniform("P", clip_from_centre)
            program.set_uniform("M", translation(-scene.centre_m) @ placed.world_from_model)
            self._set_cut_out(program, primitive.material)
            self._draw_both_sides(primitive)
            self._reset_active_textures()
        GL.glUseProgram(0)

    def _set_light(self, program: ShaderProgram, light: Light) -> None:
        program.set_uniform("sun_direction", np.asarray(light.sun_direction, dtype=float))
        program.set_uniform("sun_irradiance", np.asarray(light.sun_irradiance, dtype=float))
        program.set_uniform("sky_scale", float(light.sky_scale))
        program.set_uniform("shadow_texel_m", float(light.shadow_texel_m))
        # pyrender's set_uniform knows no arrays.
        place = GL.glGetUniformLocation(program._program_id, "irradiance_sh")
        harmonics = np.ascontiguousarray(light.irradiance_sh, dtype=np.float32)
        GL.glUniform3fv(place, len(harmonics), harmonics)
        light.sky_texture.use(location=_SKY_UNIT)
        light.shadow_texture.use(location=_SHADOW_UNIT)

    def _set_cut_out(self, program: ShaderProgram, material: Any) -> None:
        """A mask casts by its own cut-off; what is blended casts where it is more than half."""
        cut_offs = {"MASK": float(material.alphaCutoff), "BLEND": 0.5}
        cut_off = cut_offs.get(material.alphaMode, 0.0)
        texture = material.baseColorTexture if cut_off > 0.0 else None
        program.set_uniform("alpha_cutoff", cut_off)
        program.set_uniform("base_alpha", float(material.baseColorFactor[3]))
        program.set_uniform("has_alpha_texture", 0.0 if texture is None else 1.0)
        if texture is not None:
            program.set_uniform("alpha_layer", material.layer_of.get("baseColorTexture", 0))
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


def translation(offset_m: NDArray) -> NDArray[np.float64]:
    """Matrix (4, 4) that moves by an offset (3,)."""
    matrix = np.eye(4)
    matrix[:3, 3] = offset_m
    return matrix


def _from_near_to_far(
    scene: PyrenderScene, eye_m: NDArray
) -> Iterator[tuple[PlacedPrimitive, Any]]:
    """Opaque primitives from near to far, which spares hidden fragments, then the others back."""
    by_distance = sorted(
        scene.placed, key=lambda placed: float(np.linalg.norm(placed.centre_m - eye_m))
    )
    blended = [placed for placed in by_distance if placed.primitive.is_transparent]
    opaque = [placed for placed in by_distance if not placed.primitive.is_transparent]
    for placed in opaque + blended[::-1]:
        yield placed, placed.primitive


def _set_surface(program: ShaderProgram, material: Any) -> None:
    cutoff = float(material.alphaCutoff) if material.alphaMode == "MASK" else 0.0
    program.set_uniform("alpha_cutoff", cutoff)
    program.set_uniform("opaque", 0.0 if material.alphaMode == "BLEND" else 1.0)
    for name, map_name in _LAYER_UNIFORMS.items():
        program.set_uniform(name, material.layer_of.get(map_name, 0))
    program.set_uniform("normal_scale", float(material.normal_scale))
    program.set_uniform("occlusion_strength", float(material.occlusion_strength))
    program.set_uniform("dielectric_f0", 0.0 if material.matte else DIELECTRIC_F0)
