"""A model's error against the measured skies, as the study prints it."""

from vrut_lite_lab.study.framework.directions import directions
from vrut_lite_lab.study.framework.errors import rmse, total_rmse


def error_mw(model, measured):
    """RMSE in mW m^-2 sr^-1 nm^-1 over measured skies."""
    zenith, azimuth = directions()
    each = [
        rmse(
            model.sky_radiance(sky.sun_zenith_rad, zenith, azimuth - sky.sun_azimuth_rad),
            sky.radiance,
        )
        for sky in measured
    ]
    return 1000.0 * total_rmse(each)
