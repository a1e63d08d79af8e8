"""The error of a scene file."""


class SceneFileError(ValueError):
    """What is wrong with a scene file and what to do; the path is added by `load_scene`."""


class UnreadFile(SceneFileError):
    """A file that a scene names is missing or not one that may be read.

    A scene is whole without its pictures: those are left out, and told with the reason in `why`
    (such as "missing").
    """

    def __init__(self, message: str, why: str) -> None:
        super().__init__(message)
        self.why = why
