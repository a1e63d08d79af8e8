"""The module `lamps`: switches its frame part, whose failures are its Faults."""

from vrut_lite import __version__
from vrut_lite.kernel.module import Manifest, Module

NAME = "lamps"


class DrawnLamps(Module):
    """Computes nothing: the part hears the opened scene, with its lamps, while this module runs."""

    manifest = Manifest(name=NAME, title="Lamps", version=__version__, provides=(NAME,))
