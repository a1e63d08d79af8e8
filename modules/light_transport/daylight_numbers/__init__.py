"""Daylight in numbers: illuminance at sensors, daylight factors, a year.

Rays from each sensor are traced once and kept as a matrix over cells of the sky and patches of the
light map; an hour or a year is then a product.
"""
