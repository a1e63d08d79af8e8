"""The size of the next picture, so that pictures keep up while the camera moves."""

# At nine pictures a second motion still looks continuous.
QUICK_S = 0.11
# Few sizes: each needs framebuffers of its own.
SCALES = (1.0, 0.7, 0.5, 0.35, 0.25)
# Seconds without a change before the finished picture begins: more for slow pictures, since an
# interruption costs the piece that is being drawn.
_SHORTEST_REST_S, _LONGEST_REST_S = 0.15, 0.5
_REST_SHARE = 0.3
_MEMORY = 0.5
# Renderers of Mesa and Google without a graphics card, and seconds of a full picture by them.
_ON_PROCESSORS, _ON_PROCESSORS_S = ("llvmpipe", "softpipe", "SwiftShader"), 2.0


class Pacing:
    """Estimates from each picture the time of one of full size."""

    def __init__(self) -> None:
        self._full_s = 0.0
        self._is_known = False

    def expect(self, renderer: str) -> None:
        """Guess from a renderer's name, until the first picture: a processor's are small."""
        if any(name in renderer for name in _ON_PROCESSORS):
            self._full_s = _ON_PROCESSORS_S

    def quick_scale(self) -> float:
        """The largest scale at which a picture is expected in time, or the smallest that is."""
        return next((s for s in SCALES if self._full_s * s * s <= QUICK_S), SCALES[-1])

    def rest_s(self) -> float:
        """Seconds without a change before the finished picture begins."""
        return min(max(_REST_SHARE * self._full_s, _SHORTEST_REST_S), _LONGEST_REST_S)

    def drew(self, scale: float, seconds: float) -> None:
        """Learn from the time of a picture of this scale."""
        full_s = seconds / scale**2
        known_s = self._full_s if self._is_known else full_s
        self._full_s = (1.0 - _MEMORY) * known_s + _MEMORY * full_s
        self._is_known = True


def scaled(size: tuple[int, int], scale: float) -> tuple[int, int]:
    """Width and height at a scale, never below 16 pixels."""
    width, height = (max(16, round(side * scale)) for side in size)
    return width, height
