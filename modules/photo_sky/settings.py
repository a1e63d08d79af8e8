"""The settings of a photograph as the sky."""

from typing import Annotated

import msgspec

from vrut_lite.kernel.settings import setting


class PhotoSettings(msgspec.Struct, frozen=True):
    """Which photograph, how it is turned, and how bright it is."""

    photo: Annotated[
        str,
        setting(
            "A panorama of the whole sphere, EXR or HDR, or a glTF file with one. Its sun stands "
            "where it stood: it does not follow the clock.",
            file_kinds="Panoramas (*.exr *.hdr *.glb *.gltf)",
        ),
    ] = ""
    photo_rotation_deg: Annotated[
        float, setting("How far the panorama's middle is turned, from -Z clockwise.", -360, 360,
                       unit="°", label="Turned by")
    ] = 0.0  # fmt: skip
    photo_cd_m2: Annotated[
        float | None,
        setting("Luminance of the value 1 in the file. None: the file's own, by whiteLuminance in "
                "EXR (else 683) and EXPOSURE in HDR (179 over it).", 1e-6, 1e9, unit="cd/m²",
                label="Luminance of 1"),
    ] = None  # fmt: skip
    photo_lux: Annotated[
        float | None,
        setting("Illuminance of level ground by sky and sun together, instead of that.", 1e-6, 2e5,
                unit="lx", label="Level ground"),
    ] = None  # fmt: skip
    photo_albedo: Annotated[
        float | None,
        setting("Share of light that a grey ground of this sky alone reflects. None: the place's "
                "ground.", 0, 1, label="Albedo of the ground"),
    ] = None  # fmt: skip
