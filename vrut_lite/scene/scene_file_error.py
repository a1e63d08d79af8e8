"""The error of a scene file."""


class SceneFileError(ValueError):
    """What is wrong with a scene file and what to do; the path is added by `load_scene`."""
