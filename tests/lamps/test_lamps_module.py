"""The module switches its frame part."""

import trimesh
from lamps.module import DrawnLamps

from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import EnableModule
from vrut_lite.messages.scene import LoadScene, SceneOpened
from vrut_lite.scene.manager import SceneManager


def test_the_part_hears_the_scene_while_the_module_is_on(tmp_path):
    """Off, nothing is drawn for it; on again, it hears the scene that is open."""
    path = tmp_path / "box.glb"
    trimesh.creation.box((1.0, 1.0, 1.0)).export(path)
    kernel = Kernel()
    for module in (DrawnLamps, SceneManager):
        kernel.add_module(module)
    scene = kernel.seats["scene"].module
    for message, heard in (
        (LoadScene(path=str(path)), True),
        (EnableModule(module="lamps", enabled=False), False),
        (EnableModule(module="lamps"), True),
    ):
        kernel.inject(message)
        kernel.pump_until_idle()
        shown = scene.state.parts.get("lamps", {}).get(SceneOpened)
        assert shown is (scene.state.scene if heard else None)
    kernel.close()
