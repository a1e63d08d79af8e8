"""Automatic exposure in the window: metered at once, adapting to a moved camera, or held.

The first picture of a new scene, a chosen hour or a chosen place is metered. A moved camera adapts
the exposure over half a second. The exposure then follows the picture, for example when a light map
comes late, until playing or dragged time or a setting changes the light: from then on it is held,
so that dusk darkens. In a drag it never lets the picture err by more than three stops. Times are
seconds of the engine's clock.
"""

from math import exp
from typing import Protocol

import msgspec
import numpy as np

from vrut_lite.app.engine.history import GESTURE_S
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.spherical_harmonics import evaluate_irradiance
from vrut_lite.kernel.messages import (
    ChooseSlot,
    EnableModule,
    Message,
    SetClock,
    SetSetting,
    Tick,
)
from vrut_lite.messages.ground import SetGround
from vrut_lite.messages.haze import SetHaze
from vrut_lite.messages.light_map import SurfaceLightChanged
from vrut_lite.messages.picture import NightLook, SetExposure
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.tolerance import SetTolerance
from vrut_lite.pictures.exposure import metered_cd, uncorrected_ev100
from vrut_lite.scene.scene_state import SceneState

# 95 % of the difference in stops is gone after 0.6 seconds. A finished picture waits until the
# exposure is near, because the display is frozen while it is drawn; then the rest is adapted.
_TIME_CONSTANT_S = 0.2
_ADAPTED_S = 1.5
_SETTLED_EV, _NEAR_EV = 0.04, 0.5
# Number of pixels by which a moving picture is metered.
_ENOUGH_PIXELS = 2**13
# Time between two pictures of an adaptation; a longer pause counts as the second value.
_STEP_S, _LONGEST_STEP_S = 1.0 / 60.0, 0.25
# Largest error of the exposure in stops while an hour is dragged; from there it adapts.
_MOST_OFF_EV = 3.0
# Messages that change the light of the shown scene.
_HOLDING = (Tick, SetSetting, SetTolerance, SetHaze, SetGround, ChooseSlot, EnableModule)
# All that `Adaptation.hear` acts on.
LISTENED_TO = (SetClock, SetPlace, SurfaceLightChanged, *_HOLDING)


class Metered(Protocol):
    """A picture, or the pictures of two eyes, that can be metered."""

    @property
    def ev100(self) -> float:
        """The exposure that it was drawn with."""

    def metered_ev100(self, white: float, night_look: NightLook, enough: int) -> float:
        """EV100 by which automatic exposure would expose it, by about `enough` pixels."""


class Adaptation:
    """Chooses the exposure of the next picture, and learns from each picture; one thread only.

    `wakes_at_s` is when the next picture is due although the scene's state has not changed.
    """

    def __init__(self) -> None:
        self.wakes_at_s: float | None = None
        # EV100 without compensation; None: the next picture is metered by itself.
        self._ev100: float | None = None
        # EV100 that the last metered picture asked for, and the level of its light.
        self._seen_ev100 = 0.0
        self._seen_level = 0.0
        # Whether a drag has left the exposure behind.
        self._catches_up = False
        self._stepped_s = 0.0
        # Whether the exposure follows the picture, and until when only camera moves do.
        self._follows = True
        self._follows_until_s = 0.0
        # Hours that are set before this time belong to one drag; whether that drag is still held.
        self._drag_ends_s = 0.0
        self._dragged = False
        # The layout of the light map whose first light was adapted to.
        self._lit_layout = ""
        self._state = SceneState()

    @property
    def settled(self) -> bool:
        """Whether a finished picture would have the exposure of the last one."""
        return self._arrived and self.wakes_at_s is None

    @property
    def is_near(self) -> bool:
        """Whether a finished picture may be drawn."""
        return self._way_ev < _NEAR_EV

    @property
    def held(self) -> bool:
        """Whether automatic exposure stays fixed."""
        return not self._follows

    @property
    def _arrived(self) -> bool:
        return self._way_ev < _SETTLED_EV

    @property
    def _way_ev(self) -> float:
        """How far the exposure still has to go."""
        if self._ev100 is None or not self._follows:
            return 0.0
        return abs(self._seen_ev100 - self._ev100)

    def meter_anew(self) -> None:
        """Meter the next picture by itself."""
        self._ev100, self._follows, self._dragged = None, True, False

    def hear(self, message: Message, now_s: float) -> None:
        """Note a message that the kernel delivers."""
        if isinstance(message, (SetClock, SetPlace)):
            # The first hour of a drag is metered; the next ones show how the light changes.
            if now_s >= self._drag_ends_s and self._arrived:
                self.meter_anew()
            else:
                self._hold(now_s)
                self._dragged = True
            self._drag_ends_s = now_s + GESTURE_S
        elif isinstance(message, _HOLDING):
            self._hold(now_s)
        elif isinstance(message, SurfaceLightChanged) and message.layout_key != self._lit_layout:
            self._lit_layout = message.layout_key
            self._follow(now_s)

    def exposure_of(self, state: SceneState) -> SetExposure:
        """The exposure of a finished picture: metered by itself unless it is held."""
        wish = state.exposure
        if wish.mode == "manual" or self._follows or self._ev100 is None:
            return wish
        return msgspec.structs.replace(wish, mode="manual", ev100=self._ev100)

    def next_exposure(self, state: SceneState, now_s: float) -> SetExposure:
        """The exposure of the next quick picture, a step nearer to the metered one."""
        if state.scene is not self._state.scene or state.exposure.mode == "manual":
            self.meter_anew()
        elif state.camera != self._state.camera or (self._dragged and now_s >= self._drag_ends_s):
            self._follow(now_s)
        self._state, self.wakes_at_s = state, None
        if self._ev100 is None:
            return state.exposure
        step_s = min(now_s - self._stepped_s, _LONGEST_STEP_S)
        if self._follows:
            self._adapt(self._seen_ev100 - self._ev100, step_s)
        elif self._dragged:
            self._stay_near(self._expected_ev100(state), step_s)
        # Counted from here: the time that drawing takes passes for the eye too.
        self._stepped_s = now_s
        return msgspec.structs.replace(state.exposure, mode="manual", ev100=self._ev100)

    def drew(
        self, picture: Metered, exposure: SetExposure, now_s: float, still: bool = False
    ) -> None:
        """Meter a picture that was drawn with `exposure`, which this object chose."""
        if self._state.exposure.mode == "manual":
            return
        if still:
            self._stepped_s = now_s
        if exposure.mode == "auto":
            self._ev100 = self._seen_ev100 = picture.ev100 + exposure.compensation_ev
        elif self._follows or self._dragged:
            self._seen_ev100 = picture.metered_ev100(
                self._state.white_card, exposure.night_look, _ENOUGH_PIXELS
            )
        self._seen_level = _level(self._state)
        if not self._arrived:
            self.wakes_at_s = now_s + _STEP_S
        elif self._dragged:
            self.wakes_at_s = self._drag_ends_s

    def _adapt(self, way_ev: float, step_s: float) -> None:
        assert self._ev100 is not None
        self._ev100 += way_ev * (1.0 - exp(-step_s / _TIME_CONSTANT_S))

    def _stay_near(self, wanted_ev100: float, step_s: float) -> None:
        """Hold the exposure unless it is far off; then adapt it until it is near."""
        assert self._ev100 is not None
        way_ev = wanted_ev100 - self._ev100
        self._catches_up = abs(way_ev) > (_NEAR_EV if self._catches_up else _MOST_OFF_EV)
        if self._catches_up:
            beyond_ev = max(abs(way_ev) - _MOST_OFF_EV, 0.0)
            self._ev100 += beyond_ev if way_ev > 0.0 else -beyond_ev
            self._adapt(wanted_ev100 - self._ev100, step_s)

    def _expected_ev100(self, state: SceneState) -> float:
        """EV100 expected of a state, whose picture is as much brighter than the last as its light.

        By night less than in proportion: the picture keeps some of the darkness.
        """
        level, look = _level(state), state.exposure.night_look
        if level <= 0.0 or self._seen_level <= 0.0:
            return self._seen_ev100
        mean_cd = metered_cd(self._seen_ev100, look) * level / self._seen_level
        return uncorrected_ev100(mean_cd, look)

    def _follow(self, now_s: float) -> None:
        if not self._follows and self._ev100 is not None:
            self._seen_ev100 = self._ev100
        self._follows, self._dragged = True, False
        self._follows_until_s = now_s + _ADAPTED_S

    def _hold(self, now_s: float) -> None:
        self._follows = now_s < self._follows_until_s


def _level(state: SceneState) -> float:
    """Luminance of white level ground in the open, times a constant; 0 without light."""
    light = state.sky_light
    if light is None:
        return 0.0
    ambient, key_light = light.ambient, light.key_light
    sky_rgb = evaluate_irradiance(ambient.irradiance_sh_rgb.values, (0.0, 1.0, 0.0))
    direct_rgb = np.asarray(key_light.irradiance_rgb) * max(0.0, key_light.direction[1])
    return max(0.0, float(luminance(np.maximum(sky_rgb, 0.0) + direct_rgb)))
