"""Quantities as text, written alike wherever they are shown."""

# A tenth of the light of an overcast night without moon.
_DARK_LX = 1e-5
_DARK = "dark: light of stars and cities is left out"


def lux_text(lux: float) -> str:
    """Lux in three figures and more, from starlight to noon; where none is left, why."""
    if lux < _DARK_LX:
        return _DARK
    return f"{lux:,.0f} lx" if lux >= 100.0 else f"{lux:.3g} lx"
