"""Samples of materials: a ball and a panel of each kind on a chequered floor."""

from collections.abc import Callable
from typing import Any

import numpy as np

from vrut_lite_lab.scene_samples.document import PANEL_AT, Document

_SIDE = 64
_AT = np.indices((_SIDE, _SIDE))


def _grey(values: Any) -> Any:
    """Pixels (h, w, 3) of numbers in [0, 1]."""
    return np.repeat(np.round(255 * np.asarray(values, float))[..., None], 3, axis=2)


def both(**how: Any) -> Callable[[Document], None]:
    """Ball and panel of one material, before two columns."""

    def make(document: Document) -> None:
        document.behind()
        material = document.material(**how)
        document.ball(material)
        document.panel(material)

    return make


def blended(document: Document) -> None:
    """Alpha of a texture, from clear to solid, and of a factor."""
    document.behind()
    alpha = np.dstack([np.full((_SIDE, _SIDE, 3), (230, 190, 60)), 255 * _AT[1] // (_SIDE - 1)])
    ramp = {"baseColorTexture": document.texture(alpha)}
    more: dict[str, Any] = {"alphaMode": "BLEND", "doubleSided": True}
    document.panel(document.material((1, 1, 1), pbr=ramp, **more))
    document.ball(document.material((0.2, 0.6, 0.2), alpha=0.5, alphaMode="BLEND"))


def cut_out(document: Document) -> None:
    """A fence of wires that are an eighth as wide as their meshes, near and far."""
    wires = (np.min(_AT % 16, axis=0) < 2)[..., None] * np.array([40, 60, 40, 255])
    mask = {"baseColorTexture": document.texture(wires)}
    fence = document.material((1, 1, 1), pbr=mask, alphaMode="MASK", doubleSided=True)
    document.behind()
    document.panel(fence)
    document.panel(fence, (-2.0, 0.6, -8.0))
    document.panel(fence, (-0.8, 0.6, 0.2), scale=[0.8, 0.8, 0.8])


def thick(**more: Any) -> Callable[[Document], None]:
    """A ball and a slab of greenish glass, closed bodies."""

    def make(document: Document) -> None:
        document.behind()
        for thickness_m, place in ((0.8, document.ball), (0.1, document.slab)):
            volume = {
                "thicknessFactor": thickness_m,
                "attenuationDistance": 1.0,
                "attenuationColor": [0.6, 0.9, 0.7],
            }
            khr = {"transmission": {"transmissionFactor": 1.0}, "volume": volume, **more}
            place(document.material((1, 1, 1), 0.0, khr=khr))

    return make


def mixed(document: Document) -> None:
    """A pane of coloured glass whose map leaves a frame of paint, and a body."""
    document.behind()
    inside = np.all((_AT > 8) & (_AT < _SIDE - 8), axis=0)
    glass = {"transmissionFactor": 1.0, "transmissionTexture": document.texture(_grey(inside))}
    document.panel(document.material((0.5, 0.85, 0.6), 0.0, khr={"transmission": glass}))
    volume = {
        "thicknessFactor": 0.8,
        "attenuationDistance": 0.5,
        "attenuationColor": [0.9, 0.6, 0.3],
    }
    body = {"transmission": {"transmissionFactor": 1.0}, "volume": volume, "ior": {"ior": 1.45}}
    document.ball(document.material((1, 1, 1), 0.0, khr=body))


def filmed(document: Document) -> None:
    """A soap-like film of growing thickness, on a mirror and on black paint."""
    film = {
        "iridescenceFactor": 1.0, "iridescenceIor": 1.8, "iridescenceThicknessMinimum": 100.0,
        "iridescenceThicknessMaximum": 900.0,
        "iridescenceThicknessTexture": document.texture(_grey(_AT[1] / (_SIDE - 1))),
    }  # fmt: skip
    document.panel(document.material((0.7, 0.7, 0.7), 0.2, 1.0, khr={"iridescence": film}))
    even = {"iridescenceFactor": 1.0, "iridescenceIor": 1.8, "iridescenceThicknessMaximum": 420.0}
    document.ball(document.material((0.02, 0.02, 0.02), 0.15, khr={"iridescence": even}))


def sampled(document: Document) -> None:
    """Four panels: repeated, clamped, mirrored, and enlarged to hard texels."""
    arrow = np.array([[220, 40, 40], [240, 200, 60], [40, 90, 200], [40, 170, 90]], np.uint8)
    pixels = arrow.reshape(2, 2, 3)
    kinds: list[dict[str, Any]] = [
        {"wrapS": 10497, "wrapT": 10497}, {"wrapS": 33071, "wrapT": 33071},
        {"wrapS": 33648, "wrapT": 33648}, {"wrapS": 10497, "magFilter": 9728},
    ]  # fmt: skip
    twice = {"KHR_texture_transform": {"scale": [2.5, 2.5]}}
    document.uses("KHR_texture_transform")
    for number, sampler in enumerate(kinds):
        info = {**document.texture(pixels, **sampler), "extensions": twice}
        paint = document.material((1, 1, 1), 1.0, pbr={"baseColorTexture": info})
        document.panel(paint, (0.95 * (number - 1.5), 0.5, 0.0), scale=[0.8, 0.8, 0.8])


def glossy(document: Document) -> None:
    """Specular and glossiness: gold paint over black."""
    document.uses("KHR_materials_pbrSpecularGlossiness")
    spec = {"diffuseFactor": [0.02, 0.02, 0.02, 1.0], "specularFactor": [0.9, 0.65, 0.2],
            "glossinessFactor": 0.75}  # fmt: skip
    number = document.add(
        "materials", {"extensions": {"KHR_materials_pbrSpecularGlossiness": spec}}
    )
    document.ball(number)
    document.panel(number)


def bumpy(document: Document) -> None:
    """Maps of normals, occlusion, roughness and metal, and vertex colours."""
    slope = np.cos(_AT * 2 * np.pi * 4 / _SIDE) * 0.35
    normal = np.dstack([slope[1], slope[0], np.sqrt(1 - slope[0] ** 2 - slope[1] ** 2)])
    stripes = (_AT[0] // 8) % 2
    rough = np.dstack([np.ones_like(stripes), 0.3 + 0.5 * stripes, stripes]) * 255
    material = document.material(
        (0.8, 0.5, 0.3), 1.0, 1.0, pbr={"metallicRoughnessTexture": document.texture(rough)},
        normalTexture=document.texture(np.round(127.5 * (normal + 1))),
    )  # fmt: skip
    document.ball(material)
    document.panel(material)


def one_sided(document: Document) -> None:
    """A panel whose back faces the eye is not seen; beside it one that shows both sides."""
    turned = {"rotation": [0.0, 1.0, 0.0, 0.0]}
    document.panel(document.material((0.7, 0.2, 0.2)), (-0.75, 0.6, 0.0), **turned)
    document.panel(document.material((0.2, 0.2, 0.7), doubleSided=True), PANEL_AT, **turned)


_PANE = {"transmission": {"transmissionFactor": 1.0}}
SURFACES: dict[str, Callable[[Document], None]] = {
    "alpha blend": blended,
    "cut-out": cut_out,
    "thin glass": both(colour=(0.6, 0.85, 0.9), rough=0.0, khr=_PANE, doubleSided=True),
    "thick glass": thick(),
    "rough glass": both(colour=(1, 1, 1), rough=0.35, khr=_PANE, doubleSided=True),
    "glass by maps": mixed,
    "dispersion": thick(dispersion={"dispersion": 0.36}),
    "clearcoat": both(colour=(0.5, 0.03, 0.03), rough=0.7, khr={"clearcoat": {
        "clearcoatFactor": 1.0, "clearcoatRoughnessFactor": 0.05}}),
    "specular, ior": both(colour=(0.05, 0.05, 0.05), rough=0.15, khr={
        "ior": {"ior": 1.9}, "specular": {"specularColorFactor": [1.0, 0.6, 0.3]}}),
    "sheen": both(colour=(0.08, 0.02, 0.12), rough=0.9, khr={"sheen": {
        "sheenColorFactor": [0.9, 0.6, 0.9], "sheenRoughnessFactor": 0.4}}),
    "iridescence": filmed,
    "anisotropy": both(colour=(0.8, 0.8, 0.8), rough=0.3, metal=1.0, khr={"anisotropy": {
        "anisotropyStrength": 0.9}}),
    "emissive strength": both(colour=(0.1, 0.1, 0.1), rough=0.6, emissiveFactor=[1.0, 0.5, 0.1],
                              khr={"emissive_strength": {"emissiveStrength": 8000.0}}),
    "unlit": both(colour=(0.2, 0.5, 0.8), khr={"unlit": {}}),
    "samplers": sampled,
    "spec-gloss": glossy,
    "core maps": bumpy,
    "single-sided": one_sided,
}  # fmt: skip
