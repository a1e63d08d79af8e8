"""The module `air`: switches its frame part, whose failures are its Faults."""

from vrut_lite.kernel.module import Manifest, Module

NAME = "air"


class DrawnAir(Module):
    """Computes nothing: the part hears the air of the sky, which is demanded while this runs."""

    manifest = Manifest(name=NAME, title="Air", version="0.1.0", provides=(NAME,))
