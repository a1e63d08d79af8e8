"""What is seen while a scene is opened."""

from PySide6.QtCore import QRectF
from window_driver import SCENES

from vrut_lite.messages.scene import SceneOpened


def test_a_scene_on_its_way_is_named_and_something_moves(shared_headless_window):
    """Until its first picture: else a window looks dead for seconds."""
    driver = shared_headless_window
    loading = driver.window.desk.viewport.loading
    assert not loading.is_on
    moves = []
    loading.changed.connect(lambda: moves.append(loading.text))
    driver.window.files.open_path(str(SCENES / "spheres.glb"))
    assert "Opening spheres.glb" in loading.text
    # It asks to be painted again and again, while the engine reads the file.
    driver.until(lambda: len(moves) > 2)
    driver.until_heard(SceneOpened, lambda m: m.path.endswith("spheres.glb"))
    driver.until(lambda: not loading.is_on)
    assert loading.text == ""
    place = QRectF(0.0, 0.0, 400.0, 300.0)
    assert place.contains(loading.region(place))
