"""Bodies that a section plane opens: shapes whose inside no light reaches."""

import numpy as np

from vrut_lite.geometry.connected import connected_components
from vrut_lite.messages.scene_content import Mesh
from vrut_lite.numeric_types import BoolArray

# The attribute of a mesh's triangles, as mitsuba wants it named.
IS_BODY = "face_is_body"
# Largest share of open edges (with one triangle) of a closed shape: a dome on a floor has some, a
# house with windows more.
_MOST_OPEN = 0.05


def in_bodies(mesh: Mesh) -> BoolArray:
    """Which triangles (F,) belong to a shape that is closed, or nearly so.

    Corners at one place are one.
    """
    _, place = np.unique(mesh.positions_m, axis=0, return_inverse=True)
    corners = place.reshape(-1)[mesh.triangles].astype(np.int64)
    count = int(corners.max()) + 1
    starts, ends = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    shape = connected_components(count, starts, ends)[starts]
    is_open = ~np.isin(starts * count + ends, ends * count + starts)
    share = np.bincount(shape, is_open) / np.maximum(np.bincount(shape), 1)
    return np.asarray((share <= _MOST_OPEN)[shape.reshape(-1, 3)[:, 0]])
