"""Random sessions with the installed modules at a small size, recorded and replayed.

    python tests/recording/random_skies.py record FOLDER COUNT
    python tests/recording/random_skies.py replay FOLDER

so that one process may record for one processor and another replay for another.
"""

import random
import sys
from datetime import UTC, datetime, timedelta
from pathlib import Path

from vrut_lite.daylight_kernel import daylight_kernel, demand_light
from vrut_lite.kernel.messages import ChooseSlot, Demand, EnableModule, SetClock, SetSetting
from vrut_lite.messages.place import SetPlace
from vrut_lite.messages.sky import LookAlong
from vrut_lite.messages.tolerance import SetTolerance
from vrut_lite.recording.journal_reader import Journal
from vrut_lite.recording.recorder import Recorder
from vrut_lite.recording.replay import Replay

SKIES = ("dynamic_skylight", "bruneton_sky")
INPUTS = 25


def any_input(dice):
    """An input of a seeded dice: mostly hours, of day and night."""
    sky = dice.choice(SKIES)
    hour = datetime(2026, 6, 21, tzinfo=UTC) + timedelta(hours=dice.uniform(0.0, 24.0))
    return dice.choice(
        [
            SetClock(instant=hour),
            SetClock(instant=hour),
            SetClock(instant=hour),
            SetPlace(latitude_deg=dice.uniform(-70, 70), longitude_deg=dice.uniform(-30, 30)),
            SetSetting(module=sky, name="turbidity", value=dice.uniform(2.0, 9.0)),
            SetSetting(module="clouds", name="coverage", value=dice.random()),
            ChooseSlot(slot="sky", module=sky),
            EnableModule(module="clouds", enabled=dice.random() < 0.5),
            LookAlong(direction=(0.6, dice.choice([0.64, -0.64]), 0.48)),
            SetTolerance(tolerance=dice.choice([0.1, 0.05])),
            Demand(consumer="test", message="CloudsChanged"),
        ]
    )


def record(folder, seed):
    dice = random.Random(seed)
    kernel, _ = daylight_kernel()
    with (folder / f"sky_{seed}.mcap").open("wb") as stream:
        recorder = Recorder(kernel, stream)
        demand_light(kernel, "test", 16)
        kernel.inject(SetPlace(latitude_deg=50.0, longitude_deg=14.0))
        for _ in range(INPUTS):
            kernel.inject(any_input(dice))
            kernel.pump_until_idle()
        recorder.close()
    kernel.close()


if __name__ == "__main__":
    place = Path(sys.argv[2])
    if sys.argv[1] == "record":
        for number in range(int(sys.argv[3])):
            record(place, number)
        print("recorded")
    else:
        for path in sorted(place.glob("sky_*.mcap")):
            outcome = Replay(Journal(path)).run()
            by = "value" if outcome.by_value else "digest"
            print(f"compared by {by}: {outcome.difference}", flush=True)
