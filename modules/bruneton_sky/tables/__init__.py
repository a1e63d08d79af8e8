"""Precomputed tables of scattered light, and looking things up in them."""
