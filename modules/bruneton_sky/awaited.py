"""What is to be said when the GPU has made the textures that it is about."""

import msgspec

from vrut_lite.daylight.air import AirChanged
from vrut_lite.daylight.sky import BackgroundChanged
from vrut_lite.gpu_job import GpuJob, GpuTexture
from vrut_lite.kernel.messages import Derived

Message = BackgroundChanged | AirChanged


class Awaited:
    """Messages whose textures are still being made, by the jobs' names and recipes."""

    def __init__(self) -> None:
        self._messages: dict[str, dict[str, Message]] = {}

    def first(self, name: str, job: GpuJob | None, message: Message) -> Derived:
        """What to say now: the job that must be done before the message, or the message.

        A message that needs no job is newer than all that waits under the name.
        """
        waiting = self._messages.setdefault(name, {})
        if job is None:
            waiting.clear()
            return message
        waiting.pop(job.recipe, None)
        waiting[job.recipe] = message
        return job

    def next(self, name: str, texture: GpuTexture) -> Message | None:
        """The message that waited for this texture; None if it or a newer one has been said."""
        waiting = self._messages.get(name, {})
        if texture.recipe not in waiting:
            return None
        while True:
            recipe = next(iter(waiting))
            message = waiting.pop(recipe)
            if recipe == texture.recipe:
                return _with(message, texture)


def _with(message: Message, texture: GpuTexture) -> Message:
    if isinstance(message, BackgroundChanged):
        return msgspec.structs.replace(message, cube=texture)
    volume = message.volume
    assert volume is not None
    return msgspec.structs.replace(message, volume=msgspec.structs.replace(volume, light=texture))
