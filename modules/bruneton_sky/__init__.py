"""The sky of a spherical atmosphere: Rayleigh and Mie scattering, ozone, one observer.

Single scattering, after Bruneton and Neyret 2008 and Bruneton 2017, for any number of
wavelengths and any sun, from the ground to the top of the atmosphere.
"""

from bruneton_sky.atmosphere import Atmosphere
from bruneton_sky.single_scattering import single_scattering

__all__ = ["Atmosphere", "single_scattering"]
