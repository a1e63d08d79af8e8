"""Skies of the weather: CIE general skies, Perez's all-weather sky, the hours of an EPW year."""
