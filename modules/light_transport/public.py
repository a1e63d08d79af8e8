"""Names of light transport that daylight numbers and share may use; no other module imports it.

* `SceneTransport.of_scene` with the `TransportSizes` of `quality_for` a tolerance, over
  `surfaces_of` the scene; `first_rays` is its first round. `CancelCheck`, `always` and `unless` end
  such work.
* The light of an hour, `Illumination`, by `hour_of` messages; `node_radiances` are its sky in the
  table's cells, `NODES`, `GROUND_NODE`, `EDGE`, and their map `sine_of_height`,
  `disc_radius`, `relative_solid_angle`; `columns_and_rays` are the table's entries.
* `MirrorRays` of `mirror_parts`: the surroundings of glossy parts, by `SceneTransport.add_mirrors`.
* Where rays end: a `RayScene` and its `Tree`, `tree_of` surfaces alone, `first_hits`, and for
  kernels (`hot`, `inlined`) `nearest_along`, `mixed`, `met_row`, `scratch`, `MISS`, `GROUND`;
  `edges_of` triangles of `Surfaces`.
"""

from light_transport.giving_up import CancelCheck, always, unless
from light_transport.hour.illumination import Illumination
from light_transport.jobs import hour_of
from light_transport.kernels import hot, inlined
from light_transport.rays.map_texels import edges_of
from light_transport.rays.mirror_rays import MirrorRays, mirror_parts
from light_transport.rays.ray_scene import RayScene, tree_of
from light_transport.rays.ray_starts import scratch
from light_transport.rays.ray_table import columns_and_rays, met_row
from light_transport.rays.sky_nodes import (
    EDGE,
    GROUND_NODE,
    NODES,
    disc_radius,
    node_radiances,
    relative_solid_angle,
    sine_of_height,
)
from light_transport.rays.trace import MISS, first_hits, mixed, nearest_along
from light_transport.rays.tree import Tree
from light_transport.surfaces.surfaces import GROUND, Surfaces, surfaces_of
from light_transport.tolerance import TransportSizes, quality_for
from light_transport.transport import SceneTransport, first_rays

__all__ = [
    "EDGE",
    "GROUND",
    "GROUND_NODE",
    "MISS",
    "NODES",
    "CancelCheck",
    "Illumination",
    "MirrorRays",
    "RayScene",
    "SceneTransport",
    "Surfaces",
    "TransportSizes",
    "Tree",
    "always",
    "columns_and_rays",
    "disc_radius",
    "edges_of",
    "first_hits",
    "first_rays",
    "hot",
    "hour_of",
    "inlined",
    "met_row",
    "mirror_parts",
    "mixed",
    "nearest_along",
    "node_radiances",
    "quality_for",
    "relative_solid_angle",
    "scratch",
    "sine_of_height",
    "surfaces_of",
    "tree_of",
    "unless",
]
