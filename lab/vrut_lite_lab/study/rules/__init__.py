"""Errors of the integration rules for single scattering against the exact integral."""
