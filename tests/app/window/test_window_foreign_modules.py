"""A broken package of somebody else never keeps the window from starting."""

import pytest
from foreign_packages import EXITING, RAISING, on_path, put
from window_driver import HeadlessStage, WindowDriver


@pytest.mark.parametrize("code", [RAISING, EXITING, None], ids=["raises", "exits", "no file"])
def test_the_window_starts_and_says_why_a_module_is_missing(qtbot, tmp_path, code):
    """The Modules panel names the package and offers safe mode; every other module has its row."""
    points = {f"vrut_lite.{group}": {"broken": "broken:Foreign"} for group in
              ("modules", "panels", "frame_parts", "sky_layers")}  # fmt: skip
    put(tmp_path / "site", "broken", code, points=points)
    with on_path(tmp_path / "site"):
        driver = WindowDriver(qtbot, HeadlessStage, tmp_path / "kept")
        driver.window.docks["modules"].show()
        manager = driver.panel("modules")
        driver.until(lambda: "broken" in manager.failures.text())
        told = manager.failures.text()
        assert "of broken 1.0, by Ada, BSD-3-Clause, failed to load" in told
        assert "`vrut-lite run --safe-mode` starts without modules of others" in told
        assert manager.list.topLevelItemCount() >= 12
        driver.close()
