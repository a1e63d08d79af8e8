"""The module `air`: switches its frame part, whose failures are its Faults."""

from vrut_lite import __version__
from vrut_lite.kernel.module import Manifest, Module

NAME = "air"


class DrawnAir(Module):
    """Computes nothing: the part hears the air of the sky, which is demanded while this runs."""

    manifest = Manifest(name=NAME, title="Air", version=__version__, provides=(NAME,))
