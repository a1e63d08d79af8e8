"""A bus of one module, for tests of DynamicSkyLight."""

from datetime import UTC, datetime

from vrut_lite.daylight.place import SetPlace
from vrut_lite.daylight.sky import AmbientChanged, BackgroundChanged
from vrut_lite.daylight.sun import KeyLightChanged
from vrut_lite.kernel.messages import ClockMoved, Demand

NOON = ClockMoved(instant=datetime(2026, 6, 21, 11, 0, tzinfo=UTC))
PRAGUE = SetPlace(latitude_deg=50.0755, longitude_deg=14.4378, altitude_m=235.0)
SKY = (BackgroundChanged, KeyLightChanged, AmbientChanged)


class FakeLink:
    """A bus of one module: remembers what is said, and says it to no one."""

    def __init__(self, *held):
        self.held = set(held)
        self.demands = {}
        self.memory = {}
        self.posted = []

    def post(self, message):
        self.posted.append(message)
        self.memory[type(message)] = message

    def wanted(self, message_type):
        return self.demands.get(message_type)

    def holds(self, slot):
        return slot in self.held

    def last(self, message_type):
        return self.memory.get(message_type)


def tell(module, link, message):
    """Deliver a message to its handler, remembered first as the kernel does."""
    link.memory[type(message)] = message
    for kind, method in module.handlers():
        if kind is type(message):
            getattr(module, method)(message)


def want(link, *kinds, size=None):
    """Demand message types of a link."""
    for kind in kinds:
        link.demands[kind] = Demand(consumer="test", message=kind.__name__, size=size)
