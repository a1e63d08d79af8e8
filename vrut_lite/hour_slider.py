"""The notebook's widget: a picture and a slider of the hour."""

from collections.abc import Callable
from typing import Any

import anywidget
import traitlets

_SCRIPT = """
function shown(hour) {
  const minutes = Math.round(hour * 60);
  return String(Math.floor(minutes / 60)).padStart(2, "0") + ":"
    + String(minutes % 60).padStart(2, "0");
}
export default {
  render({ model, el }) {
    const image = document.createElement("img");
    const slider = document.createElement("input");
    const label = document.createElement("span");
    Object.assign(slider, { type: "range", min: 0, max: 23.75, step: 0.25 });
    slider.setAttribute("aria-label", "hour");
    image.style.display = "block";
    image.style.maxWidth = "100%";
    slider.style.width = "min(540px, 85%)";
    const draw = () => {
      const old = image.src;
      image.src = URL.createObjectURL(new Blob([model.get("picture")], { type: "image/png" }));
      if (old) URL.revokeObjectURL(old);
    };
    const tell = () => {
      slider.value = model.get("hour");
      label.textContent = " " + shown(model.get("hour"));
    };
    // A picture takes a fraction of a second: one is asked for when the hand lets go.
    slider.addEventListener("input", () => { label.textContent = " " + shown(+slider.value); });
    slider.addEventListener("change", () => {
      model.set("hour", +slider.value);
      model.save_changes();
    });
    model.on("change:picture", draw);
    model.on("change:hour", tell);
    draw();
    tell();
    el.append(image, slider, label);
  },
};
"""


class HourSlider(anywidget.AnyWidget):
    """Shows the picture of the hour that it is set to.

    Args:
        picture_at: an hour of the day to a PNG.
        hour: the first.
    """

    _esm = _SCRIPT
    hour = traitlets.Float(12.0, min=0.0, max=24.0).tag(sync=True)
    picture = traitlets.Bytes(b"").tag(sync=True)

    def __init__(self, picture_at: Callable[[float], bytes], hour: float):
        super().__init__(hour=hour, picture=picture_at(hour))
        self._picture_at = picture_at
        self.observe(self._draw, names="hour")

    def _draw(self, change: dict[str, Any]) -> None:
        self.picture = self._picture_at(change["new"])
