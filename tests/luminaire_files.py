"""Files of idealised luminaires: a Lambertian panel as IES, a cosine's power as EULUMDAT."""

import numpy as np

GAMMA_DEG = np.arange(0.0, 90.5, 1.0)


def _rows(values):
    lines = [" ".join(f"{v:.9g}" for v in values[k : k + 10]) for k in range(0, len(values), 10)]
    return "\n".join(lines)


def panel_ies(flux_lm=3000.0, size_m=(0.6, 0.6, 0.0), watts=25.0, lumens="-1", unit=2):
    """A Lambertian panel of absolute photometry; `size_m` is width, length, height."""
    candela = flux_lm / np.pi * np.cos(np.radians(GAMMA_DEG)).clip(0.0)
    size = " ".join(f"{v:g}" for v in size_m)
    return "\n".join(
        [
            "IESNA:LM-63-2002", "[TEST] idealised, computed", "[LUMINAIRE] Lambertian panel",
            "TILT=NONE", f"1 {lumens} 1 {len(GAMMA_DEG)} 1 1 {unit} {size}", f"1 1 {watts:g}",
            _rows(GAMMA_DEG), "0", _rows(candela), "",
        ]
    )  # fmt: skip


def spot_ldt(flux_lm=800.0, power=8.0, watts=9.0, diameter_mm=60.0, step_deg=1.0):
    """A spot whose intensity falls as a power of the cosine, with rotational symmetry."""
    gamma = np.arange(0.0, 90.0 + step_deg / 2, step_deg)
    per_klm = (power + 1.0) / (2.0 * np.pi) * 1000.0 * np.cos(np.radians(gamma)).clip(0.0) ** power
    head = [
        "idealised, computed", "1", "1", "1", "0", f"{len(gamma)}", f"{step_deg:g}", "none",
        "cosine spot", "", "spot.ldt", "2026", f"{diameter_mm:g}", "0", "80",
        f"{diameter_mm:g}", "0", "0", "0", "0", "0", "100", "100", "1", "0", "1",
        "1", "LED", f"{flux_lm:g}", "3000", "80", f"{watts:g}", *["0.5"] * 10, "0",
    ]  # fmt: skip
    return "\n".join([*head, *(f"{g:g}" for g in gamma), *(f"{v:.9g}" for v in per_klm), ""])
