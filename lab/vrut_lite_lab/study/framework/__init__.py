"""Bruneton's 2016 evaluation of clear sky models, rebuilt: measurements, colours, errors."""
