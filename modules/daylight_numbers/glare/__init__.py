"""Glare at eyes: what they see, and the probability that it disturbs."""
