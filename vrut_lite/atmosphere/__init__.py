"""Physics of the air: gases, aerosols, refraction, sunlight through air; functions on arrays."""
