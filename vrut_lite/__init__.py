"""vrut_lite: a small kernel that links modules by messages; its first modules make daylight."""

__version__ = "0.1.0"
