"""Spectra of light and of surfaces, and what eyes make of them: pure functions on arrays."""
