"""pyrender's renderer with our passes and shaders.

pyrender keeps vertex buffers, textures and programs in the shared GL context. Its own passes
are not used: they draw into framebuffer 0, clamp to 8 bits and have no sky.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from vrut_lite.frame_part import PlacedSurface
from vrut_lite.geometry.polarisation import UNPOLARISED_ROUGHNESS
from vrut_lite.geometry.reflection import DIELECTRIC_F0
from vrut_lite.messages.scene_content import MapName
from vrut_lite.messages.section import Section
from vrut_lite.render import direct_gl
from vrut_lite.render.gl_environment import import_pyrender
from vrut_lite.render.light import Light, Reflection, Shadows
from vrut_lite.render.passes.caster_renderer import CasterRenderer, cut_out_defines, is_all_solid
from vrut_lite.render.passes.deferred_meshes import DeferredMeshes
from vrut_lite.render.passes.draw_order import alpha_range
from vrut_lite.render.passes.programs import Program
from vrut_lite.render.passes.shadows_on_mesh import OnMesh, bind_shadows, shadows_on
from vrut_lite.render.passes.specular_filter import LEVEL_ROUGHNESS
from vrut_lite.render.passes.triangles import Side, draw_side, sides
from vrut_lite.render.passes.view import View, normal_matrix
from vrut_lite.render.pyrender_scene import PlacedPrimitive, PyrenderScene, Uploads
from vrut_lite.render.shader_files import Defines
from vrut_lite.render.surface_terms import term_defines

import_pyrender()
from OpenGL import GL  # noqa: E402  (pyrender's repairs must come first)
from pyrender.constants import ProgramFlags, RenderFlags  # noqa: E402

# Texture units of mesh.frag; the first ones are a material's, which pyrender numbers.
_SKY_UNIT, _REFLECTION_UNIT, _REFLECTANCE_UNIT = 8, 10, 11
# Roughness from which both lobes of `sky_image` are as wide as the first level of the map.
_NO_MIRROR = (0.8 - math.sqrt(0.64 - 1.44 * LEVEL_ROUGHNESS[0])) / 0.72
# Defines of surfaces whose light depends on changes from pixel to pixel.
_CHANGES_READ_BY = ("MIRROR", "VIEW_LIGHT")
_LAYER_UNIFORMS: dict[str, MapName] = {
    "base_color_layer": "base_colour",
    "metallic_roughness_layer": "metallic_roughness",
    "normal_layer": "normal",
    "occlusion_layer": "occlusion",
    "emissive_layer": "emission",
}


class SurfaceLighting(Protocol):
    """The frame part that lights surfaces, where there is one."""

    def surface_defines(self, surface: PlacedSurface) -> Defines:
        """Defines of the program of a surface that it lights."""

    def bind_surface(self, surface: PlacedSurface) -> Mapping[str, Any]:
        """Bind the surface's textures; returns values of its program's uniforms."""


class MeshRenderer(CasterRenderer):
    """Draws the meshes of a pyrender scene into the bound framebuffer."""

    def __init__(self) -> None:
        super().__init__()
        # Clip plane of the scene's meshes, but not of the ground disc and of shadows.
        self.section: Section | None = None
        self._levels_finer = 0.0
        # Uniforms of a mesh's placement, cached for the last view.
        self._uploads: Uploads | None = None
        self._places: dict[PlacedPrimitive, dict[str, NDArray[np.float64]]] = {}
        self._places_seen_by: View | None = None
        # Uniforms of a mesh's surface, by whether it is drawn blended.
        self._surfaces: dict[tuple[PlacedPrimitive, bool], dict[str, Any]] = {}
        # Programs by primitive and defines.
        self._programs: dict[tuple[Any, Defines], Program] = {}
        # Number and count of the pictures averaged into one: each covers other pixels of cut-outs
        # and samples another part of the sun.
        self.picture_number, self.picture_count = 0, 1

    def draw_depth_of_solid(self, placed_in_order: Iterable[PlacedPrimitive], view: View) -> None:
        """Draw the depth of opaque meshes; the next pass shades fragments of equal depth."""
        solid = (p for p in placed_in_order if is_all_solid(p.primitive.material))
        self.draw_whole_depth(solid, view)

    def draw_whole_depth(self, placed_in_order: Iterable[PlacedPrimitive], view: View) -> None:
        """Draw the depth of whole triangles, including cut-out texels."""
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthMask(GL.GL_TRUE)
        GL.glColorMask(*4 * [GL.GL_FALSE])
        for placed in placed_in_order:
            self._draw_depth_of(placed, view, Side(0 if placed.is_two_sided else GL.GL_BACK))
        GL.glColorMask(*4 * [GL.GL_TRUE])

    def draw_surfaces(
        self,
        placed_in_order: Iterable[PlacedPrimitive],
        view: View,
        lighting: SurfaceLighting,
        deferred: DeferredMeshes,
    ) -> None:
        """Draw the depth of opaque meshes, and attributes of deferred ones."""
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthMask(GL.GL_TRUE)
        GL.glDepthFunc(GL.GL_GREATER)
        for placed in placed_in_order:
            if placed in deferred.numbers:
                of_light = lighting.surface_defines(placed)
                read = (define for define in _CHANGES_READ_BY if define in of_light)
                defines = ("ONE_SAMPLE", "TO_BUFFER", *read, *self._cuts(placed))
                program = self._mesh_program(placed.primitive, defines)
                deferred.set_place(program, placed)
                self._set_place(program, placed, view)
                draw_side(placed.primitive, Side(GL.GL_BACK))
                direct_gl.disable(GL.GL_CLIP_DISTANCE0)
            elif is_all_solid(placed.primitive.material):
                GL.glColorMask(*4 * [GL.GL_FALSE])
                self._draw_depth_of(placed, view, Side(0 if placed.is_two_sided else GL.GL_BACK))
                GL.glColorMask(*4 * [GL.GL_TRUE])

    def _draw_depth_of(self, placed: PlacedPrimitive, view: View, side: Side) -> None:
        self._set_place(self._depth_program(*self._cuts(placed)), placed, view)
        draw_side(placed.primitive, side)
        direct_gl.disable(GL.GL_CLIP_DISTANCE0)

    def _cuts(self, placed: PlacedPrimitive) -> Defines:
        return ("SECTION",) if self.section is not None and not placed.is_ground else ()

    def _set_place(self, program: Program, placed: PlacedPrimitive, view: View) -> None:
        """Set a mesh's matrices relative to the eye, and its clip plane."""
        if self._places_seen_by is not view:
            self._places_seen_by, self._places = view, {}
        place = self._places.get(placed)
        if place is None:
            eye_from_model = placed.world_from_model.copy()
            eye_from_model[:3, 3] -= view.eye_m
            place = self._places[placed] = {
                "clip_from_model": view.clip_from_eye @ eye_from_model,
                "eye_from_model": eye_from_model,
                "clip_from_eye": view.clip_from_eye,
                "normal_matrix": normal_matrix(eye_from_model),
            }
        program.set_uniforms("place", place)
        if self._cuts(placed):
            program.set_uniform("section", _seen_from(self.section, view.eye_m))
            direct_gl.enable(GL.GL_CLIP_DISTANCE0)

    def update(self, scene: PyrenderScene) -> None:
        """Upload the scene's new buffers and textures, and free those no longer in it."""
        if scene.uploads is not self._uploads:
            self._uploads, self._places_seen_by = scene.uploads, None
            self._programs.clear()
            self._surfaces.clear()
            # Films of other scenes would gather.
            self._terms.release()
        super().update(scene)

    def read_finer(self, scene: PyrenderScene, levels: float) -> None:
        """Sample maps `levels` mip levels finer than their level of detail."""
        if levels == self._levels_finer:
            return
        self._levels_finer = levels
        for placed in scene.placed:
            for _, texture in _textures(placed.primitive.material):
                if texture is not None:
                    GL.glBindTexture(GL.GL_TEXTURE_2D, texture._texid)
                    GL.glTexParameterf(GL.GL_TEXTURE_2D, GL.GL_TEXTURE_LOD_BIAS, -levels)
        GL.glBindTexture(GL.GL_TEXTURE_2D, 0)

    def draw(
        self,
        scene: PyrenderScene,
        placed_in_order: Iterable[PlacedPrimitive],
        view: View,
        light: Light,
        shadows: Shadows,
        reflection: Reflection,
        lighting: SurfaceLighting,
        defines: Defines,
        defines_on: Callable[[PlacedPrimitive], Defines],
        blended: bool = False,
        deferred: DeferredMeshes | None = None,
    ) -> None:
        """Draw meshes of the scene, one after another, with reversed depth.

        `defines` apply to all programs, `defines_on` adds those of a mesh. Blended materials draw
        their opaque texels, or with `blended` the others. `deferred` meshes are lit in pixels of
        their numbers.
        """
        GL.glEnable(GL.GL_DEPTH_TEST)
        compares = GL.GL_GREATER if blended else GL.GL_GEQUAL
        GL.glDepthFunc(compares if deferred is None else GL.GL_EQUAL)
        GL.glDepthMask(GL.GL_TRUE if deferred is None and not blended else GL.GL_FALSE)
        of_picture = {
            "reflection_scale": float(reflection.scale),
            "level_roughness": np.array(LEVEL_ROUGHNESS),
            "picture_number": self.picture_number,
            "sun_direction": np.asarray(light.sun_direction, dtype=float),
            "sun_irradiance": np.asarray(light.sun_irradiance, dtype=float),
            "sky_scale": float(light.mirrored.scale),
            "irradiance_sh": np.asarray(light.irradiance_sh),
            "picture_count": self.picture_count,
        }
        if light.mirrored_polarised is not None:
            of_picture["polarisation_scale"] = light.mirrored_polarised.scale
            of_picture["polariser_axis"] = light.polariser
        _bind_maps(light, shadows, reflection)
        known_shadows: dict[str, OnMesh] = {}
        lit: Defines = () if deferred is None else ("FROM_BUFFER",)
        for placed in placed_in_order:
            of_light = lighting.surface_defines(placed)
            shadow_defines, shadow_uniforms = shadows_on(placed, shadows, view, known_shadows)
            for side in sides(placed, blended):
                own = (
                    *shadow_defines,
                    *(lit or self._cuts(placed)),
                    *cut_out_defines(placed.primitive.material),
                    *_lobe_defines(placed.primitive.material),
                    *_polarised_defines(placed.primitive.material, light),
                    *term_defines(placed.primitive.material, blended),
                    *of_light,
                    *defines_on(placed),
                    *side.defines,
                )
                program = self._mesh_program(placed.primitive, (*defines, *own))
                program.set_uniforms("picture", of_picture)
                program.set_uniforms("shadow", shadow_uniforms)
                self._set_surface(program, placed, blended)
                if of_light:
                    program.set_uniforms("light", lighting.bind_surface(placed))
                if deferred is None:
                    self._set_place(program, placed, view)
                    draw_side(placed.primitive, side, blended)
                    direct_gl.disable(GL.GL_CLIP_DISTANCE0)
                else:
                    deferred.draw(program, placed)
        GL.glUseProgram(0)
        GL.glDisable(GL.GL_BLEND)
        # Glass uses dual-source blending. While that blend function is set, Mesa cannot draw into
        # two targets, even without blending.
        direct_gl.blend_function(GL.GL_ONE, GL.GL_ZERO)
        GL.glDepthMask(GL.GL_TRUE)
        GL.glDepthFunc(GL.GL_GREATER)

    def _mesh_program(self, primitive: Any, defines: Defines) -> Program:
        """The program of a mesh with these defines, bound."""
        program = self._programs.get((primitive, defines))
        if program is None or not program._in_context():
            self._program_cache.also = defines
            program = self._programs[primitive, defines] = self._get_primitive_program(
                primitive, RenderFlags.NONE, ProgramFlags.USE_MATERIAL
            )
        program._bind()
        return program

    def _set_surface(self, program: Program, placed: PlacedPrimitive, blended: bool) -> None:
        uniforms = self._surfaces.get((placed, blended))
        # The ground's albedo changes with the hour.
        if uniforms is None or placed.is_ground:
            uniforms = self._surfaces[placed, blended] = _surface_uniforms(placed, blended)
        program.set_uniforms("surface", uniforms)
        material = placed.primitive.material
        self._terms.bind(material, placed.world_from_model)
        for unit, (_, texture) in enumerate(_textures(material)):
            if texture is not None:
                direct_gl.active_texture(GL.GL_TEXTURE0 + unit)
                direct_gl.bind_texture(GL.GL_TEXTURE_2D, texture._texid)


def _lobe_defines(material: Any) -> Defines:
    """Defines that omit reflections, mirror images or the alpha test where not needed."""
    solid: Defines = ("SOLID",) if is_all_solid(material) else ()
    if material.matte:
        return ("MATTE", *solid)
    is_rough = material.least_roughness >= _NO_MIRROR and material.terms.clearcoat <= 0.0
    return ("BLURRED", *solid) if is_rough else solid


def _polarised_defines(material: Any, light: Light) -> Defines:
    """Defines of reflections that are polarised, by a dielectric or before a polariser."""
    terms, filtered = material.terms, light.polariser is not None
    is_metal = material.metallicFactor >= 1.0 and material.metallicRoughnessTexture is None
    is_smooth = material.least_roughness < UNPOLARISED_ROUGHNESS and (filtered or not is_metal)
    has_coat = terms.clearcoat > 0.0 and terms.clearcoat_roughness < UNPOLARISED_ROUGHNESS
    if light.mirrored_polarised is None or material.matte or not (is_smooth or has_coat):
        return ()
    return ("POLARISED", "POLARISER") if filtered else ("POLARISED",)


def _textures(material: Any) -> Iterable[tuple[str, Any]]:
    """The textures that a material may have, by the shader's names."""
    yield "normal", material.normalTexture
    yield "occlusion", material.occlusionTexture
    yield "emissive", material.emissiveTexture
    yield "base_color", material.baseColorTexture
    yield "metallic_roughness", material.metallicRoughnessTexture


def _bind_maps(light: Light, shadows: Shadows, reflection: Reflection) -> None:
    light.mirrored.texture.use(location=_SKY_UNIT)
    if light.mirrored_polarised is not None:
        light.mirrored_polarised.bind()
    bind_shadows(shadows)
    reflection.texture.use(location=_REFLECTION_UNIT)
    reflection.reflectance.use(location=_REFLECTANCE_UNIT)


def _surface_uniforms(placed: PlacedPrimitive, blended: bool) -> dict[str, Any]:
    """Uniforms of a mesh's surface; texture units follow the order of `_textures`."""
    material = placed.primitive.material
    first, end = alpha_range(placed.primitive, blended)
    uniforms = {
        "alpha_cutoff": first,
        "alpha_end": end,
        "opaque": 0.0 if blended else 1.0,
        "normal_scale": float(material.normal_scale),
        "occlusion_strength": float(material.occlusion_strength),
        "dielectric_f0": 0.0 if material.matte else DIELECTRIC_F0,
        "material.emissive_factor": np.asarray(material.emissiveFactor, dtype=float),
        "material.base_color_factor": np.asarray(material.baseColorFactor, dtype=float),
        "material.metallic_factor": float(material.metallicFactor),
        "material.roughness_factor": float(material.roughnessFactor),
    }
    for name, map_name in _LAYER_UNIFORMS.items():
        uniforms[name] = material.layer_of.get(map_name, 0)
    for unit, (name, _) in enumerate(_textures(material)):
        uniforms[f"material.{name}_texture"] = unit
    return uniforms


def _seen_from(section: Section | None, eye_m: NDArray[np.float64]) -> NDArray[np.float32]:
    """The plane (4,) for positions relative to an eye."""
    assert section is not None
    distance_m = section.offset_m - float(np.dot(section.normal, eye_m))
    return np.array([*section.normal, distance_m], np.float32)
