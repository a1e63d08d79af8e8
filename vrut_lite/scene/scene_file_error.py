"""The error of a scene file."""


class SceneFileError(ValueError):
    """A fault in a scene file and its remedy; `load_scene` adds the path."""
