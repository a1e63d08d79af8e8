"""vrut_lite: a small kernel that connects modules by messages, and daylight for scenes."""

from vrut_lite.compiled_code import find_room
from vrut_lite.environment_checks import leave_out_nonsense

__version__ = "1.0.0"

leave_out_nonsense()
find_room(__version__)
