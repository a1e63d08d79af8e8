"""An atmosphere as the uniforms of shaders/atmosphere.glsl: numbers, never a new shader."""

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.phase import mie_phase_parameters
from vrut_lite.gpu_job import UniformValue

WAVELENGTHS = 3
MOST_ABSORBER_NODES = 8


def atmosphere_uniforms(atmosphere: Atmosphere) -> dict[str, UniformValue]:
    """Uniforms by name, for an atmosphere with three wavelengths.

    Raises:
        ValueError: it has another number of wavelengths, or more than 8 absorber nodes.
    """
    count = len(atmosphere.wavelength_nm)
    if count != WAVELENGTHS:
        raise ValueError(f"a shader's atmosphere needs {WAVELENGTHS} wavelengths, not {count}")
    nodes = _absorber_nodes(atmosphere)
    if nodes > MOST_ABSORBER_NODES:
        raise ValueError(
            f"a shader's atmosphere has room for {MOST_ABSORBER_NODES} absorber nodes, not {nodes}"
        )
    padding = (0.0,) * (MOST_ABSORBER_NODES - nodes)
    return {
        "ground_radius_m": atmosphere.ground_radius_m,
        "top_altitude_m": atmosphere.top_altitude_m,
        "scale_height_m": (atmosphere.rayleigh_scale_height_m, atmosphere.mie_scale_height_m),
        "solar_irradiance": atmosphere.solar_irradiance,
        "rayleigh_scattering": atmosphere.rayleigh_scattering,
        "mie_scattering": atmosphere.mie_scattering,
        "mie_extinction": atmosphere.mie_extinction,
        "fog_scattering": atmosphere.fog_scattering,
        "fog_extinction": atmosphere.fog_extinction,
        "fog_scale_height_m": atmosphere.fog_scale_height_m if atmosphere.foggy else 0.0,
        "absorption_extinction": atmosphere.absorption_extinction,
        "mie_phase": tuple(mie_phase_parameters(atmosphere)),
        "absorber_nodes": nodes,
        "absorber_altitude_m": atmosphere.absorber_altitude_m[:nodes] + padding,
        "absorber_density": atmosphere.absorber_density[:nodes] + padding,
    }


def _absorber_nodes(atmosphere: Atmosphere) -> int:
    """None where nothing absorbs: the shaders then skip the absorber's paths."""
    absorbs = any(atmosphere.absorption_extinction) and any(atmosphere.absorber_density)
    return len(atmosphere.absorber_altitude_m) if absorbs else 0
