"""pyrender's renderer with our shaders: buffers and textures are its, the light is ours.

pyrender keeps vertex buffers, textures and programs in the shared GL context. Its own passes
are not used: they draw into framebuffer 0, clamp to 8 bits and know no sky.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.light import Light

pyrender = import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)
from pyrender.constants import ProgramFlags, RenderFlags  # noqa: E402
from pyrender.shader_program import ShaderProgram, ShaderProgramCache  # noqa: E402

SHADERS = Path(__file__).parent / "shaders"
# As mesh.frag binds them; the first units are a material's textures, which pyrender numbers.
_SKY_UNIT, _SHADOW_UNIT = 8, 9
# Glass, plastic, stone: glTF 2.0, appendix B.2.
DIELECTRIC_F0 = 0.04


class MeshRenderer(pyrender.Renderer):  # type: ignore[name-defined]
    """Draws the meshes of a pyrender scene into whatever framebuffer is bound."""

    def __init__(self) -> None:
        super().__init__(1, 1)
        self._program_cache = ShaderProgramCache(shader_dir=str(SHADERS))
        self.light: Light | None = None

    def __del__(self) -> None:
        """Do nothing: pyrender would free GL objects from whatever thread collects garbage."""

    def update(self, scene: Any) -> None:
        """Bring the scene's buffers and textures to the GPU, and free those that left it."""
        # Rows of 3-channel textures are packed; GL's default would skew odd widths.
        GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
        self._update_context(scene, RenderFlags.NONE)

    def draw(self, scene: Any, view: NDArray, projection: NDArray, light: Light) -> None:
        """Draw all meshes, opaque first, with matrices (4, 4) of the camera."""
        self.light = light
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LESS)
        GL.glDepthMask(GL.GL_TRUE)
        eye = np.linalg.inv(view)[:3, 3]
        for node, primitive in self._primitives(scene, eye):
            program = self._get_primitive_program(
                primitive, RenderFlags.NONE, ProgramFlags.USE_MATERIAL
            )
            program._bind()
            _set_camera(program, view, projection)
            program.set_uniform("cam_pos", eye)
            self._set_light(program, light)
            _set_surface(program, primitive.material)
            self._bind_and_draw_primitive(
                primitive, scene.get_pose(node), program, RenderFlags.NONE
            )
            self._reset_active_textures()
        GL.glUseProgram(0)
        GL.glDisable(GL.GL_BLEND)

    def draw_depth(self, scene: Any, view_projection: NDArray, casters: set[Any]) -> None:
        """Draw the depth of the nodes that cast shadows, both sides of every face."""
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LESS)
        GL.glDepthMask(GL.GL_TRUE)
        for node, primitive in self._primitives(scene, np.zeros(3)):
            if node not in casters:
                continue
            program = self._get_primitive_program(primitive, RenderFlags.NONE, ProgramFlags.NONE)
            program._bind()
            _set_camera(program, np.eye(4), view_projection)
            program.set_uniform("M", scene.get_pose(node))
            self._set_cut_out(program, primitive.material)
            self._draw_both_sides(primitive)
            self._reset_active_textures()
        GL.glUseProgram(0)

    def _primitives(self, scene: Any, eye: NDArray) -> Iterator[tuple[Any, Any]]:
        """Opaque ones from near to far, which spares hidden fragments, then the others back."""

        def distance(node: Any) -> float:
            centre = node.mesh.centroid
            world = scene.get_pose(node) @ np.append(centre, 1.0)
            return float(np.linalg.norm(world[:3] - eye))

        nodes = sorted(scene.mesh_nodes, key=distance)
        blended = [node for node in nodes if node.mesh.is_transparent]
        for node in [n for n in nodes if not n.mesh.is_transparent] + blended[::-1]:
            for primitive in node.mesh.primitives:
                yield node, primitive

    def _set_light(self, program: ShaderProgram, light: Light) -> None:
        program.set_uniform("sun_direction", np.asarray(light.sun_direction, dtype=float))
        program.set_uniform("sun_irradiance", np.asarray(light.sun_irradiance, dtype=float))
        program.set_uniform("sky_scale", float(light.sky_scale))
        program.set_uniform("shadow_matrix", light.shadow_matrix)
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


def _set_camera(program: ShaderProgram, view: NDArray, projection: NDArray) -> None:
    program.set_uniform("V", view)
    program.set_uniform("P", projection)


def _set_surface(program: ShaderProgram, material: Any) -> None:
    cutoff = float(material.alphaCutoff) if material.alphaMode == "MASK" else 0.0
    program.set_uniform("alpha_cutoff", cutoff)
    program.set_uniform("opaque", 0.0 if material.alphaMode == "BLEND" else 1.0)
    matte = getattr(material, "matte", False)
    program.set_uniform("dielectric_f0", 0.0 if matte else DIELECTRIC_F0)
