"""The integration rules for single scattering, held against truth and not against a sky."""
