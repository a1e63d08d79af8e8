"""A bundled list of cities, searched by name."""

import csv
import unicodedata
from functools import lru_cache
from importlib.resources import files
from typing import NamedTuple


class City(NamedTuple):
    """A city; degrees, north and east positive, metres above the sea."""

    name: str
    country: str
    latitude_deg: float
    longitude_deg: float
    altitude_m: float

    @property
    def title(self) -> str:
        """Name and country."""
        return f"{self.name}, {self.country}"


@lru_cache(maxsize=1)
def all_cities() -> tuple[City, ...]:
    """The list, by name."""
    text = files("vrut_lite.app").joinpath("data/cities.csv").read_text(encoding="utf-8")
    return tuple(
        City(name, country, *(float(number) for number in numbers))
        for name, country, *numbers in list(csv.reader(text.splitlines()))[1:]
    )


def find_cities(text: str, most: int = 8) -> list[City]:
    """Cities whose name begins with the text, then those that contain it; accents are ignored."""
    wanted = folded(text.partition(",")[0].strip())
    if not wanted:
        return []
    begins = [city for city in all_cities() if folded(city.name).startswith(wanted)]
    has = [city for city in all_cities() if wanted in folded(city.name) and city not in begins]
    return (begins + has)[:most]


def folded(text: str) -> str:
    """Without accents and capitals."""
    decomposed = unicodedata.normalize("NFKD", text.casefold())
    return "".join(letter for letter in decomposed if not unicodedata.combining(letter))
