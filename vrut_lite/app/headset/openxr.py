"""A session of OpenXR: the runtime's clock, the eyes' poses, and textures for their pictures.

The textures are of the process's own OpenGL context, by XR_MNDX_egl_enable: Monado has it, and
runtimes that are built on Monado. Methods that touch OpenGL are called on the GL thread, `wait` and
the others on the headset's thread: waiting for the runtime's clock stops nothing else.
"""

import ctypes
import math
from collections.abc import Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np

from vrut_lite.app.headset.runtime import egl_binding, import_xr, name_of, open_runtime
from vrut_lite.app.headset.standing import RoomPose, rotation_of
from vrut_lite.app.view.camera_rig import EYE_HEIGHT_M
from vrut_lite.errors import UserError

# Formats of textures of sRGB values in four bytes a pixel: GL_SRGB8_ALPHA8, else GL_RGBA8.
_FORMATS = (0x8C43, 0x8058)


class LocatedEye(NamedTuple):
    """An eye in the room.

    Attributes:
        pose: of the eye, in the room's axes.
        tangents: of the angles from its axis to the left, right, lower and upper edge.
        view: the runtime's own description of both.
    """

    pose: RoomPose
    tangents: tuple[float, float, float, float]
    view: Any


class HeadsetFrame(NamedTuple):
    """A frame of the runtime: when it will be seen (its own time in ns), and whether it will be."""

    display_time: int
    is_seen: bool


class OpenXrSession:
    """An instance of a runtime with a headset, and after `begin` a session with a texture an eye.

    Attributes:
        xr: the package pyopenxr.
        instance: the runtime's instance.
        session: the session; None before `begin`.
        room: the space in which poses are located, its origin on the floor.
        sizes_px: width and height of each eye's picture.
        is_running: whether the runtime wants frames.
        has_ended: whether the session was ended, here or by the runtime.

    Raises:
        UserError: no pyopenxr, no runtime, no headset, or no way to draw for it.
    """

    def __init__(self) -> None:
        self.xr = xr = import_xr()
        self.session: Any = None
        self.room: Any = None
        self.sizes_px: list[tuple[int, int]] = []
        self.is_running = self.has_ended = False
        # All swapchains, and of each eye its own with the names of its textures.
        self._swapchains: list[Any] = []
        self._eyes: list[tuple[Any, list[int]]] = []
        self._taken: list[Any] = []
        self.instance = open_runtime(xr)
        try:
            wanted = xr.SystemGetInfo(xr.FormFactor.HEAD_MOUNTED_DISPLAY)
            self._system = xr.get_system(self.instance, wanted)
        except xr.XrException as error:
            xr.destroy_instance(self.instance)
            raise UserError(
                f"the OpenXR runtime finds no headset ({name_of(error)}): connect one, and try "
                "again"
            ) from error

    # --- on the headset's thread -----------------------------------------------------------

    def poll(self) -> None:
        """Follow what the runtime says of the session."""
        xr = self.xr
        while True:
            try:
                event = xr.poll_event(self.instance)
            except xr.EventUnavailable:
                return
            if event.type == xr.StructureType.EVENT_DATA_SESSION_STATE_CHANGED:
                kind = ctypes.POINTER(xr.EventDataSessionStateChanged)
                changed = ctypes.cast(ctypes.byref(event), kind).contents
                self._follow(xr.SessionState(changed.state))
            elif event.type == xr.StructureType.EVENT_DATA_INSTANCE_LOSS_PENDING:
                self.is_running, self.has_ended = False, True

    def _follow(self, state: Any) -> None:
        xr = self.xr
        if state == xr.SessionState.READY:
            stereo = xr.ViewConfigurationType.PRIMARY_STEREO
            xr.begin_session(self.session, xr.SessionBeginInfo(stereo))
            self.is_running = True
        elif state == xr.SessionState.STOPPING:
            self.is_running = False
            xr.end_session(self.session)
        elif state in (xr.SessionState.EXITING, xr.SessionState.LOSS_PENDING):
            self.is_running, self.has_ended = False, True

    def ask_to_end(self) -> None:
        """Ask the runtime to end the session, of which `poll` then hears."""
        if self.is_running:
            self.xr.request_exit_session(self.session)
        else:
            self.has_ended = True

    def wait(self) -> HeadsetFrame:
        """Wait until the runtime wants the next frame."""
        state = self.xr.wait_frame(self.session, self.xr.FrameWaitInfo())
        return HeadsetFrame(state.predicted_display_time, bool(state.should_render))

    def eyes(self, frame: HeadsetFrame) -> list[LocatedEye]:
        """The eyes as they will be when a frame is seen; none while the head is not tracked."""
        xr = self.xr
        stereo = xr.ViewConfigurationType.PRIMARY_STEREO
        info = xr.ViewLocateInfo(stereo, frame.display_time, self.room)
        state, views = xr.locate_views(self.session, info)
        flags = xr.ViewStateFlags
        needed = flags.ORIENTATION_VALID_BIT | flags.POSITION_VALID_BIT
        if state.view_state_flags & needed != needed:
            return []
        return [LocatedEye(pose_of(view.pose), tangents_of(view.fov), view) for view in views]

    # --- on the GL thread ------------------------------------------------------------------

    def begin(self) -> None:
        """Create the session for the current OpenGL context, and a swapchain for each eye.

        Raises:
            UserError: the runtime does not take pictures of this context.
        """
        xr = self.xr
        try:
            self._ask_for_versions()
            # The runtime may keep the binding's address.
            self._binding = egl_binding(xr)
            info = xr.SessionCreateInfo(system_id=self._system, next=self._binding)
            self.session = xr.create_session(self.instance, info)
            self.room = self._room()
            self._make_swapchains()
        except xr.XrException as error:
            raise UserError(
                f"the OpenXR runtime takes no pictures of this OpenGL ({name_of(error)}): it must "
                "use the same graphics card (VRUT_LITE_GPU)"
            ) from error

    def _ask_for_versions(self) -> None:
        """Ask which versions of OpenGL the runtime takes; it wants to be asked."""
        xr = self.xr
        address = xr.get_instance_proc_addr(self.instance, "xrGetOpenGLGraphicsRequirementsKHR")
        ask = ctypes.cast(address, xr.PFN_xrGetOpenGLGraphicsRequirementsKHR)
        found = xr.GraphicsRequirementsOpenGLKHR()
        result = xr.check_result(xr.Result(ask(self.instance, self._system, ctypes.byref(found))))
        if result.is_exception():
            raise result

    def _room(self) -> Any:
        """The space of the user's room, its floor as the runtime knows it or below the eyes."""
        xr = self.xr
        offered = {
            xr.ReferenceSpaceType(each) for each in xr.enumerate_reference_spaces(self.session)
        }
        kind, floor = xr.ReferenceSpaceType.STAGE, xr.Posef()
        if kind not in offered:
            kind = xr.ReferenceSpaceType.LOCAL
            floor.position.y = -EYE_HEIGHT_M
        return xr.create_reference_space(self.session, xr.ReferenceSpaceCreateInfo(kind, floor))

    def _make_swapchains(self) -> None:
        xr = self.xr
        stereo = xr.ViewConfigurationType.PRIMARY_STEREO
        for view in xr.enumerate_view_configuration_views(self.instance, self._system, stereo):
            size = view.recommended_image_rect_width, view.recommended_image_rect_height
            swapchain, textures = self.swapchain(size)
            self._eyes.append((swapchain, textures))
            self.sizes_px.append(size)

    def swapchain(self, size_px: tuple[int, int], is_still: bool = False) -> tuple[Any, list[int]]:
        """A swapchain of a size, and the names of its textures; one if it `is_still`.

        Raises:
            UserError: the runtime has no textures of four bytes a pixel.
        """
        xr = self.xr
        offered = list(xr.enumerate_swapchain_formats(self.session))
        stored_as = next((each for each in _FORMATS if each in offered), None)
        if stored_as is None:
            raise UserError("the OpenXR runtime has no textures of four bytes a pixel")
        usage, flags = xr.SwapchainUsageFlags, xr.SwapchainCreateFlags
        info = xr.SwapchainCreateInfo(
            create_flags=flags.STATIC_IMAGE_BIT if is_still else flags.NONE,
            usage_flags=usage.COLOR_ATTACHMENT_BIT | usage.TRANSFER_DST_BIT,
            format=stored_as,
            sample_count=1,
            width=size_px[0],
            height=size_px[1],
            face_count=1,
            array_size=1,
            mip_count=1,
        )
        made = xr.create_swapchain(self.session, info)
        self._swapchains.append(made)
        images = xr.enumerate_swapchain_images(made, xr.SwapchainImageOpenGLKHR)
        return made, [image.image for image in images]

    def sub_image(self, swapchain: Any, size_px: tuple[int, int]) -> Any:
        """The whole picture of a swapchain of a size, for a layer."""
        xr = self.xr
        place = xr.Rect2Di(xr.Offset2Di(0, 0), xr.Extent2Di(*size_px))
        return xr.SwapchainSubImage(swapchain, place, 0)

    def begin_frame(self) -> None:
        """Begin the frame that `wait` returned."""
        # One before that was not ended is no failure.
        with suppress(self.xr.FrameDiscarded):
            self.xr.begin_frame(self.session, self.xr.FrameBeginInfo())

    def take_textures(self) -> list[int]:
        """Names of a texture for each eye, to be given back before the frame ends."""
        xr, names = self.xr, []
        for swapchain, textures in self._eyes:
            number = xr.acquire_swapchain_image(swapchain, xr.SwapchainImageAcquireInfo())
            self._taken.append(swapchain)
            info = xr.SwapchainImageWaitInfo(timeout=xr.INFINITE_DURATION)
            xr.wait_swapchain_image(swapchain, info)
            names.append(textures[number])
        return names

    def give_textures_back(self) -> None:
        """Let the runtime read the textures that were taken."""
        while self._taken:
            info = self.xr.SwapchainImageReleaseInfo()
            self.xr.release_swapchain_image(self._taken.pop(), info)

    def end_frame(
        self, frame: HeadsetFrame, eyes: Sequence[LocatedEye], over: Sequence[Any] = ()
    ) -> None:
        """Show the textures that were given back as seen by these eyes, and layers over them.

        Without eyes nothing is shown.
        """
        xr, layers = self.xr, []
        if eyes:
            views = [
                xr.CompositionLayerProjectionView(
                    pose=eye.view.pose,
                    fov=eye.view.fov,
                    sub_image=self.sub_image(swapchain, size),
                )
                for eye, (swapchain, _), size in zip(eyes, self._eyes, self.sizes_px, strict=True)
            ]
            layers = [xr.CompositionLayerProjection(space=self.room, views=views), *over]
        info = xr.FrameEndInfo(
            display_time=frame.display_time,
            environment_blend_mode=xr.EnvironmentBlendMode.OPAQUE,
            layers=[ctypes.byref(layer) for layer in layers],
        )
        xr.end_frame(self.session, info)

    def close(self) -> None:
        """Destroy everything, after the session has ended or failed."""
        xr = self.xr
        # A lost runtime has destroyed them already.
        with suppress(xr.XrException):
            self.give_textures_back()
        for swapchain in self._swapchains:
            with suppress(xr.XrException):
                xr.destroy_swapchain(swapchain)
        with suppress(xr.XrException):
            if self.session is not None:
                xr.destroy_session(self.session)
            xr.destroy_instance(self.instance)


def pose_of(posef: Any) -> RoomPose:
    """A pose of OpenXR."""
    at, turn = posef.position, posef.orientation
    return RoomPose(np.array([at.x, at.y, at.z]), rotation_of((turn.x, turn.y, turn.z, turn.w)))


def tangents_of(fov: Any) -> tuple[float, float, float, float]:
    """Tangents of an eye's angles (XrFovf, rad) to the left, right, lower and upper edge."""
    angles = fov.angle_left, fov.angle_right, fov.angle_down, fov.angle_up
    left, right, lower, upper = map(math.tan, angles)
    return left, right, lower, upper
