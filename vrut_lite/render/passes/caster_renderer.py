"""Shadow casters from a light's view: their depth, and the transmittance of glass.

Opaque meshes need no material: one program draws them all. Cut-outs and glass sample their maps.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vrut_lite.render.frustum import reaches
from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.light import Shadow
from vrut_lite.render.passes.draw_order import SOLID_ALPHA, has_solid_texels, is_blended
from vrut_lite.render.passes.programs import Program, Programs
from vrut_lite.render.passes.triangles import draw_triangles
from vrut_lite.render.passes.view import translation
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene
from vrut_lite.render.shader_files import SHADERS, Defines
from vrut_lite.render.surface_terms import SurfaceTermsOnGpu

pyrender = import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)
from pyrender.constants import ProgramFlags, RenderFlags  # noqa: E402


class CasterRenderer(pyrender.Renderer):  # type: ignore[name-defined]
    """Draws depth of a pyrender scene's meshes into the bound framebuffer."""

    def __init__(self) -> None:
        super().__init__(1, 1)
        self._program_cache = Programs(shader_dir=str(SHADERS))
        self._terms = SurfaceTermsOnGpu()

    def __del__(self) -> None:
        """Do nothing: pyrender would free GL objects on the thread that collects garbage."""

    def delete(self) -> None:
        """Free its GPU objects."""
        self._terms.release()
        super().delete()

    def update(self, scene: PyrenderScene) -> None:
        """Upload the scene's new buffers and textures, and free those no longer in it."""
        # Rows of 3-channel textures are packed; GL's default would skew odd widths.
        GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
        self._update_context(scene.uploads, RenderFlags.NONE)

    def _depth_program(self, *defines: str) -> Program:
        """The program that draws depth of opaque surfaces, bound."""
        self._program_cache.also = defines
        program = self._program_cache.get_program("mesh.vert", "depth_alone.frag")
        if not program._in_context():
            program._add_to_context()
        program._bind()
        return program

    def draw_depth(self, scene: PyrenderScene, shadow: Shadow) -> None:
        """Draw the depth of shadow casters, both sides of every face."""
        GL.glEnable(GL.GL_DEPTH_TEST)
        # Casters between the sun and the map's box cast into it too.
        GL.glEnable(GL.GL_DEPTH_CLAMP)
        GL.glDepthFunc(GL.GL_LESS)
        GL.glDepthMask(GL.GL_TRUE)
        for placed in _casters(scene, shadow):
            if has_solid_texels(placed.primitive):
                self._draw_caster(placed, shadow, ())
        GL.glDisable(GL.GL_DEPTH_CLAMP)
        GL.glUseProgram(0)

    def draw_tint(self, scene: PyrenderScene, shadow: Shadow, texels: int) -> None:
        """Multiply the transmittance of blended surfaces in front of the bound depth.

        Alpha becomes the depth of the surface nearest to the sun.
        """
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glEnable(GL.GL_DEPTH_CLAMP)
        GL.glDepthFunc(GL.GL_LEQUAL)
        GL.glDepthMask(GL.GL_FALSE)
        GL.glBlendEquationSeparate(GL.GL_FUNC_ADD, GL.GL_MIN)
        GL.glBlendFuncSeparate(GL.GL_ZERO, GL.GL_SRC_COLOR, GL.GL_ONE, GL.GL_ONE)
        for placed in _casters(scene, shadow):
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
        clip_from_model = shadow.matrix @ translation(-shadow.centre_m) @ placed.world_from_model
        GL.glDisable(GL.GL_CULL_FACE)
        if is_all_solid(material) and not defines:
            GL.glDisable(GL.GL_BLEND)
            self._depth_program().set_uniform("clip_from_model", clip_from_model)
            draw_triangles(primitive)
            return
        has_map = ("HAS_TRANSMISSION_TEX",) if "transmission" in material.further else ()
        self._program_cache.also = (*cut_out_defines(material), *has_map, *defines)
        program = self._get_primitive_program(primitive, RenderFlags.NONE, ProgramFlags.NONE)
        program._bind()
        program.set_uniform("clip_from_model", clip_from_model)
        if material.terms.transmits:
            self._terms.bind(material, placed.world_from_model)
        if defines:
            program.set_uniform("blended", float(material.alphaMode == "BLEND"))
            program.set_uniform("map_aspect", float(shadow.aspect))
            if "GLASS" in defines:
                program.set_uniform("map_texels", texels)
                program.set_uniform("base_tint", np.asarray(material.baseColorFactor[:3]))
            GL.glEnable(GL.GL_BLEND)
        else:
            GL.glDisable(GL.GL_BLEND)
        self._set_cut_out(program, material)
        draw_triangles(primitive)
        self._reset_active_textures()

    def _set_cut_out(self, program: Program, material: Any) -> None:
        """Set the alpha cut-off: its own for a masked surface, of opaque texels if blended."""
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


class SceneCasters:
    """The shadow casters of a scene, for `frame_part.Casters`."""

    def __init__(self, renderer: CasterRenderer, scene: PyrenderScene):
        self._renderer, self.scene = renderer, scene
        self.centre_m, self.radius_m = scene.centre_m, scene.radius_m

    def draw_depth(
        self, clip_from_place: NDArray[np.float64], place_m: NDArray[np.float64]
    ) -> None:
        """Draw their depth into the bound framebuffer."""
        self._renderer.draw_depth(self.scene, Shadow(None, clip_from_place, 0.0, place_m))


def is_all_solid(material: Any) -> bool:
    """Whether a surface is opaque everywhere, without holes."""
    return material.alphaMode == "OPAQUE" and not material.terms.transmits


def cut_out_defines(material: Any) -> Defines:
    """Defines of the programs of a surface with holes."""
    return ("CUT_OUT",) if material.is_cut_out else ()


def _casters(scene: PyrenderScene, shadow: Shadow) -> list[PlacedPrimitive]:
    """Meshes that may cast a shadow into a map."""
    return [
        placed
        for placed in scene.placed
        if placed.casts
        and reaches(shadow.matrix, placed.centre_m - shadow.centre_m, placed.radius_m)
    ]
