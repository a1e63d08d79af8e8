"""Two skies side by side at equal haze."""
