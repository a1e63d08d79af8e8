"""A room of grey walls behind a pane of measured glazing."""

import numpy as np
from boxes import box, quads
from daylight_numbers.glazing.angle_basis import KLEMS_FULL
from daylight_numbers.glazing.glass import no_glass
from daylight_numbers.glazing.pane_materials import PaneMaterials
from daylight_numbers.glazing.window_xml import MeasuredGlazing
from daylight_numbers.matrix.operator import operator_of
from daylight_numbers.matrix.sensors import free_sensors
from daylight_numbers.now import hour_at_sensors
from daylight_numbers.work import DaylightWork, bounces_of
from light_transport.transport import SceneTransport

# A box of 4 x 3 x 4 m whose side +x is all pane.
HALF, HEIGHT = 2.0, 3.0
UP = np.array([[0.0, 1.0, 0.0]])


def glazing(transmission, reflectance=0.0):
    return MeasuredGlazing("sample", KLEMS_FULL, KLEMS_FULL, transmission, reflectance, 0.0)


class Room:
    """A room of grey walls behind a pane, or behind nothing, and sensors in it."""

    def __init__(self, transmission=None, reflectance=0.0, up=UP, pane="inwards", rays=256):
        sides = box((-HALF, 0.0, -HALF), (HALF, HEIGHT, HALF), inwards=True)
        panes = [sides.pop(0)]
        if pane == "outwards":
            panes = [panes[0][::-1]]
        elif pane == "body":
            panes = box((HALF, 0.0, -HALF), (HALF + 0.02, HEIGHT, HALF))
        if transmission is not None:
            sides += panes
        self.surfaces, layout = quads(*sides, reflectance=reflectance)
        self.glass = no_glass(len(self.surfaces.part))
        self.bounces = None
        of_triangle = np.full(len(self.surfaces.part), -1)
        materials = None
        if transmission is not None:
            of_triangle[-2 * len(panes) :] = 0
            materials = PaneMaterials(("pane",), (glazing(transmission),), up, of_triangle)
            self.surfaces = materials.opaque(self.surfaces)
        self.transport = SceneTransport(self.surfaces, layout)
        self.transport.add_rays(rays)
        if materials is not None:
            self.bounces = bounces_of(self.transport, self.glass, materials)

    def work(self, places, normals, tolerance=0.05):
        """The room made ready for sensors."""
        sensors = free_sensors(places, normals, "desk")
        operator = operator_of(self.transport, self.glass, sensors, tolerance, bounces=self.bounces)
        return DaylightWork(self.transport, self.glass, sensors, operator)

    def lux(self, light, places, normals, tolerance=0.02):
        sensors = free_sensors(places, normals, "desk")
        operator = operator_of(self.transport, self.glass, sensors, tolerance, bounces=self.bounces)
        return hour_at_sensors(self.transport, self.glass, operator, sensors, light)


PLACES = np.array([[1.0, 0.8, 0.3], [-0.5, 0.8, 0.0], [-1.5, 1.5, -0.7]])
NORMALS = np.array([[0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
