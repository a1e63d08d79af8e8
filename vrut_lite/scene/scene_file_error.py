"""The error of a scene file."""


class SceneFileError(ValueError):
    """What is wrong with a scene file and what to do; the path is added by `load_scene`."""


class MissingFile(SceneFileError):
    """A file that a scene names is not there; a texture is then left out, and told."""
