"""Which renderers draw on a processor, by their names."""

_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "software", "swiftshader", "basic render")


def is_software(renderer: str) -> bool:
    """Whether a renderer of this name draws on a processor."""
    return any(part in renderer.lower() for part in _SOFTWARE)
