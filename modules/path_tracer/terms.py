"""Terms of glTF's extensions as parameters of `layered.py`'s BSDFs and of mitsuba's pane."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from path_tracer.bitmaps import Plugin, bitmap
from path_tracer.body import SMOOTH
from path_tracer.layered import PANE
from path_tracer.textures import Maps
from vrut_lite.messages.scene_content import MapName, Material, Sampler
from vrut_lite.messages.surface_terms import SurfaceTerms


def sampler_of(material: Material, name: MapName) -> Sampler:
    """The sampler of a map, or glTF's default."""
    found = material.maps.get(name)
    return Sampler() if found is None else found.sampler


def terms_of(mitsuba: Any, material: Material, maps: Maps) -> Plugin:
    """Parameters of the frame's surface from glTF's extensions."""
    terms = material.terms
    made: Plugin = {}
    if terms[:3] != SurfaceTerms()[:3]:
        f0, f90 = maps.f0_and_f90(terms)
        made |= {"f0": bitmap(mitsuba, f0, sampler_of(material, "specular_colour"))}
        made |= {"f90": bitmap(mitsuba, f90, sampler_of(material, "specular"))}
    if terms.clearcoat > 0.0:
        sampler = sampler_of(material, "clearcoat")
        made["clearcoat"] = _texture(mitsuba, terms.clearcoat, maps.clearcoat, sampler)
        made["clearcoat_roughness"] = terms.clearcoat_roughness
    if any(terms.sheen_rgb):
        made["sheen"] = mitsuba.ScalarColor3f(terms.sheen_rgb)
        made["sheen_roughness"] = terms.sheen_roughness
    if terms.anisotropy > 0.0:
        made |= {"anisotropy": terms.anisotropy, "anisotropy_rad": terms.anisotropy_rad}
    if terms.iridescence > 0.0:
        made |= {
            "iridescence": _texture(
                mitsuba, terms.iridescence, maps.iridescence, sampler_of(material, "iridescence")
            ),
            "film_thickness": _texture(
                mitsuba, 1.0, maps.film_thickness, sampler_of(material, "iridescence_thickness")
            ),
            "film_ior": terms.film_ior,
            "film_least_nm": terms.film_least_nm,
            "film_most_nm": terms.film_most_nm,
        }
    if terms.transmits and material.metallic < 1.0:
        sampler = sampler_of(material, "transmission")
        share = _texture(mitsuba, terms.transmission, maps.transmission, sampler)
        smooth = material.roughness <= SMOOTH
        made |= {"type": PANE, "transmission": share, "smooth": smooth}
    return made


def mitsubas_pane(mitsuba: Any, material: Material, maps: Maps, paint: Plugin) -> Plugin:
    """Mitsuba's own pane, which counts what bounces between its two faces."""
    tint = np.clip(material.base_colour_rgba[:3], 0.0, 1.0)
    glass = {
        "type": "thindielectric",
        "int_ior": max(material.terms.ior, 1.0001),
        "ext_ior": 1.0,
        "specular_transmittance": {"type": "rgb", "value": [float(value) for value in tint]},
    }
    share = _texture(
        mitsuba,
        material.terms.transmission,
        maps.transmission,
        sampler_of(material, "transmission"),
    )
    if share == 1.0:
        return glass
    return {"type": "blendbsdf", "weight": share, "a": paint, "b": glass}


def _texture(mitsuba: Any, factor: float, texels: NDArray | None, sampler: Sampler) -> Any:
    if texels is None:
        return float(factor)
    return bitmap(mitsuba, np.asarray(texels * np.float32(factor), np.float32), sampler)
