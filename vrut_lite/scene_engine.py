"""Names for modules that draw the scene in place of OpenGL.

Such a module names its `engine` in its manifest, for `--engine`, and has a static method
`open_engine(settings, traced)` that makes a backend: an object with `prepare(state: SceneState)`
and `draw(state, still, is_given_up: IsGivenUp) -> Picture`, which raises `errors.GivenUp` once
`is_given_up()` is true. Its settings have `spp`, the samples per pixel; `traced` is called with the
number of new samples after each step. `developed` makes the `Picture` of radiance.
"""

from vrut_lite.pictures.display import developed
from vrut_lite.pictures.picture import Picture
from vrut_lite.scene.backend import IsGivenUp
from vrut_lite.scene.scene_state import SceneState

__all__ = ["IsGivenUp", "Picture", "SceneState", "developed"]
