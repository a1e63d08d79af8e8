"""Monado's remote devices: a headset and two controllers that a test moves through a socket.

The messages are `r_remote_data` of Monado 25 (src/xrt/drivers/remote/r_interface.h).
"""

import socket
import struct

PORT = 4242
# Set before Monado is loaded, which reads them once.
ENVIRONMENT = {"P_OVERRIDE_ACTIVE_CONFIG": "remote", "XRT_COMPOSITOR_NULL": "1"}
_HEADER = b"mndrmt3\0"
_UPRIGHT = (0.0, 0.0, 0.0, 1.0)


class RemoteHeadset:
    """Head and hands in the room, their axes upright unless quaternions (x, y, z, w) turn them."""

    def __init__(self):
        self.head_m, self.head_turn = (0.0, 1.6, 0.0), _UPRIGHT
        self.hand_m, self.hand_turn = (0.2, 1.3, -0.5), _UPRIGHT
        self.left_x = self.right_x = self.trigger = 0.0
        self._socket = socket.create_connection(("127.0.0.1", PORT), timeout=20.0)

    def send(self, **parts):
        """Move to these, and keep the others."""
        vars(self).update(parts)
        self._socket.sendall(self._packed())

    def _packed(self):
        eye = struct.pack("<4f4f3f4x", *(0.0,) * 4, *_UPRIGHT, *(0.0,) * 3)
        head = eye + eye + struct.pack("<4f3f?3x", *self.head_turn, *self.head_m, False)
        left = _controller(_UPRIGHT, (-0.2, 1.3, -0.5), self.left_x, 0.0)
        right = _controller(self.hand_turn, self.hand_m, self.right_x, self.trigger)
        return _HEADER + head + left + right

    def close(self):
        self._socket.close()


def _controller(turn, place_m, thumbstick_x, trigger):
    pose = struct.pack("<4f3f", *turn, *place_m)
    still = struct.pack("<3f3f5f", *(0.0,) * 11)
    inputs = struct.pack("<3f2f1f2f", trigger, 0.0, 0.0, thumbstick_x, 0.0, 0.0, 0.0, 0.0)
    # Hand tracking, activity, and eleven buttons.
    return pose + still + inputs + struct.pack("<13?3x", False, True, *(False,) * 11)
