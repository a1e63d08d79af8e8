"""Time and place from a shadow: when, and where on Earth, the sun casts it."""
