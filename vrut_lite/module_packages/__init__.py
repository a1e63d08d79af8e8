"""Packages of modules: writing a new one, installing, updating and removing those of others."""
