"""Years of weather from files, and the suns of their hours."""
