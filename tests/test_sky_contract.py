"""Every installed sky keeps the contract of `vrut_lite.testing`."""

from vrut_lite.discovery import discover
from vrut_lite.sky.sky_module import SkyModule
from vrut_lite.testing.sky_contract import SkyContract

SKIES = [module for module in discover()[0] if issubclass(module, SkyModule) and module.follows_sun]
for sky in SKIES:
    globals()[f"Test{sky.__name__}"] = type(
        f"Test{sky.__name__}", (SkyContract,), {"module_type": sky}
    )


def test_both_installed_skies_are_tested():
    """A sky that is not found would keep any contract."""
    assert {"dynamic_skylight", "bruneton_sky"} <= {sky.manifest.name for sky in SKIES}
