"""Choice between graphics card and processor for what both can compute, by the renderer's trial.

The time of a product on a card is estimated in trial pixels: its work was timed in that unit on
llvmpipe. A card is chosen where the product takes no longer than `BUDGET_S`, so that no frame
waits visibly.
"""

from typing import Literal, NamedTuple

from vrut_lite.messages.renderer import RendererTried

DeviceSetting = Literal["auto", "cpu", "gpu"]
# Longest time of one product on a card: a quarter of a frame at 120 Hz.
BUDGET_S = 2e-3
# Edges of a card's cube map, the largest that the budget allows.
CARD_EDGES = (1024, 512, 256)
# The same with clouds; a smaller cube of them is no finer than the processor's.
CLOUDY_EDGES = (512, 256, 128)
_FACES = 6


class DeviceChoice(NamedTuple):
    """The device that computes a product, and the reason in words.

    Attributes:
        on_card: whether the card computes it.
        why: the reason.
        edge: edge of a cube map (texels); 0 where the processor or the consumer chooses it.
    """

    on_card: bool
    why: str
    edge: int = 0

    @property
    def device(self) -> str:
        """The device in words."""
        return "card" if self.on_card else "processor"


def choose_for_cube(
    setting: DeviceSetting,
    tried: RendererTried | None,
    trials_a_texel: float,
    edges: tuple[int, ...] = CARD_EDGES,
) -> DeviceChoice:
    """The device of a cube map, and its edge on a card: the largest of `edges` that it can take.

    `trials_a_texel`: work of a texel, in trial pixels.
    """
    if (chosen := _without_trial(setting, tried)) is not None:
        return chosen
    assert tried is not None
    for edge in edges:
        took_s = _FACES * edge**2 * trials_a_texel * tried.trial_ns * 1e-9
        if took_s <= BUDGET_S or (setting == "gpu" and edge == edges[-1]):
            return DeviceChoice(True, _expected(setting, tried, took_s), edge)
    return DeviceChoice(False, _expected(setting, tried, took_s))


def choose(setting: DeviceSetting, tried: RendererTried | None, trials: float) -> DeviceChoice:
    """The device of a product of as much work as so many trial pixels."""
    if (chosen := _without_trial(setting, tried)) is not None:
        return chosen
    assert tried is not None
    took_s = trials * tried.trial_ns * 1e-9
    fits = took_s <= BUDGET_S or setting == "gpu"
    return DeviceChoice(fits, _expected(setting, tried, took_s))


def _without_trial(setting: DeviceSetting, tried: RendererTried | None) -> DeviceChoice | None:
    if setting == "cpu":
        return DeviceChoice(False, "set to cpu")
    if tried is not None and not tried.is_software:
        return None
    if setting == "gpu":
        return DeviceChoice(True, "set to gpu")
    if tried is None:
        return DeviceChoice(False, "no renderer was tried")
    return DeviceChoice(False, "a processor renders")


def _expected(setting: DeviceSetting, tried: RendererTried, took_s: float) -> str:
    expected = f"{1e3 * took_s:.2g} of {1e3 * BUDGET_S:g} ms, trial {tried.trial_ns:.2g} ns"
    return f"set to gpu: {expected}" if setting == "gpu" else expected
