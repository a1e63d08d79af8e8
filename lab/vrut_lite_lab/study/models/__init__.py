"""The sky models that are compared; `model` is their common interface."""
