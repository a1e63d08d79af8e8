"""A backend and the state that it draws, of which tests change a part at a time."""

from dataclasses import replace

import msgspec

from vrut_lite.installed_parts import all_parts, heard_with, heard_without
from vrut_lite.scene.loading import LoadedScene, load_scene
from vrut_lite.scene.packing import packed
from vrut_lite.scene.scene_state import SceneState

LIGHT = {"background", "key_light", "ambient"}


class StatefulBackend:
    """Draws `state` with a backend."""

    def __init__(self, backend, **parts):
        self.backend = backend
        self.state = SceneState(parts=all_parts())
        self.change(**parts)

    def change(self, **parts):
        """Give parts of the state other values; other light is that of a clear sky."""
        self.state = replace(self.state, **parts)
        is_relit = not LIGHT.isdisjoint(parts) and "sky_light" not in parts
        if is_relit and LIGHT.isdisjoint(self.state.missing):
            self.state = self.state.under_clear_sky()
        if not {"scene", "parts"}.isdisjoint(parts) and self.state.scene is not None:
            self.hear(self.state.scene)

    def hear(self, *messages):
        """Let frame parts hear these, as the scene manager does."""
        for message in messages:
            self.state = replace(self.state, parts=heard_with(self.state.parts, message))

    def forget(self, *kinds):
        """Take back what parts heard last of these types."""
        parts = heard_without(self.state.parts, lambda kind: kind in kinds)
        self.state = replace(self.state, parts=parts)

    def draw(self, still=True, is_given_up=None):
        """The picture."""
        return self.backend.draw(self.state, still, is_given_up)

    @property
    def counters(self):
        """What frames did and skipped."""
        return self.backend.counters


def opened(scene, ground=None):
    """A scene, loaded or a file, on this ground and on no other."""
    loaded = scene if isinstance(scene, LoadedScene) else load_scene(scene)
    return msgspec.structs.replace(packed(loaded), ground=ground)
