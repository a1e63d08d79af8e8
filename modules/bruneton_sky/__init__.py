"""Bruneton sky."""
