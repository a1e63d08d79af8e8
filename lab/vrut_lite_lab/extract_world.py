"""Makes the map and the list of cities that the desktop application brings.

Coast lines and 240 cities are Natural Earth's (public domain), at 1:110 million, as the package
geopandas 0.14 carries them; further cities and all altitudes are our own, to 0.01 degrees and
some ten metres. Countries are those of the time zones.

    pip download --no-deps geopandas==0.14.4
    python lab/vrut_lite_lab/extract_world.py geopandas-0.14.4-py3-none-any.whl
"""

import csv
import struct
import sys
import unicodedata
import zipfile
from collections.abc import Iterator
from importlib.resources import files
from itertools import pairwise

import numpy as np
import tzfpy
from numpy.typing import NDArray

from vrut_lite_lab.checkout import ROOT

DATA = ROOT / "vrut_lite" / "app" / "data"
OUTLINE = ROOT / "vrut_lite" / "geometry" / "data" / "world_outline.npz"
LAND = "geopandas/datasets/naturalearth_lowres/naturalearth_lowres.shp"
CITIES = "geopandas/datasets/naturalearth_cities/naturalearth_cities"
PER_DEGREE = 100

# Altitude in metres of what lies high enough to matter to the air above it.
ALTITUDES = {
    "Abu Dhabi": 5, "Addis Ababa": 2355, "Algiers": 120, "Almaty": 850, "Amman": 900,
    "Ankara": 890, "Antananarivo": 1280, "Ashgabat": 220, "Asmara": 2325, "Asuncion": 60,
    "Baghdad": 35, "Bamako": 350, "Beijing": 45, "Belgrade": 117, "Bern": 540, "Bishkek": 800,
    "Bogota": 2600, "Brasilia": 1170, "Bucharest": 85, "Budapest": 105, "Canberra": 580,
    "Caracas": 900, "Chengdu": 500, "Damascus": 680, "Dushanbe": 800, "Gaborone": 1010,
    "Guatemala": 1500, "Harare": 1480, "Islamabad": 540, "Jerusalem": 750, "Johannesburg": 1750,
    "Kabul": 1790, "Kampala": 1190, "Kathmandu": 1400, "Khartoum": 380, "Kigali": 1570,
    "Kyiv": 180, "La Paz": 3640, "Lilongwe": 1050, "Ljubljana": 295, "Luanda": 6,
    "Lusaka": 1280, "Luxembourg": 300, "Madrid": 667, "Maseru": 1600, "Mbabane": 1240,
    "Mexico City": 2240, "Minsk": 220, "Monterrey": 540, "Moscow": 156, "Nairobi": 1795,
    "Nay Pyi Taw": 115, "Ndjamena": 298, "New Delhi": 216, "Niamey": 207, "Ottawa": 70,
    "Ouagadougou": 305, "Pretoria": 1340, "Pristina": 650, "Quito": 2850, "Riyadh": 612,
    "Rome": 21, "San Jose": 1170, "San Salvador": 650, "Sanaa": 2250, "Santiago": 570,
    "Sao Paulo": 760, "Sarajevo": 520, "Skopje": 240, "Sofia": 550, "Sucre": 2790,
    "Tashkent": 455, "Tbilisi": 450, "Tegucigalpa": 990, "Tehran": 1190, "Thimphu": 2330,
    "Tirana": 110, "Ulaanbaatar": 1310, "Vatican City": 33, "Vienna": 170, "Vientiane": 174,
    "Warsaw": 110, "Windhoek": 1655, "Yaounde": 750, "Yerevan": 990, "Zagreb": 122,
    "Abuja": 360, "Bangui": 370, "Bloemfontein": 1395, "Brazzaville": 300, "Bujumbura": 790,
    "Cairo": 23, "Dodoma": 1120, "Hargeisa": 1330, "Juba": 550, "Kinshasa": 280,
    "Guatemala City": 1500, "Lobamba": 650, "Managua": 80, "Naypyidaw": 115, "N'Djamena": 298,
    "Urumqi": 800, "Bengaluru": 920, "Baguio": 1500, "Andorra": 1020, "Vaduz": 455,
    "San Marino": 655, "Yamoussoukro": 210, "London": 11, "Paris": 35, "Podgorica": 40,
    "Nicosia": 150, "Vilnius": 110, "Chisinau": 85, "Lima": 150, "Helsinki": 15, "Oslo": 20,
    "Denver": 1610, "Atlanta": 320, "Chicago": 180, "Bangalore": 920, "Geneva": 375,
    "Zurich": 408, "Astana": 347, "Kuala Lumpur": 40, "Bandar Seri Begawan": 10,
}  # fmt: skip

# Where the table's letters were lost, and names that are older than the table or newer.
RENAMED = {"Chi?in?u": "Chisinau", "?saka": "Osaka", "K\u00f8benhavn": "Copenhagen",
           "Nur-Sultan": "Astana", "Bengaluru": "Bangalore"}  # fmt: skip
# Zones that several countries share are listed under one of them.
COUNTRIES = {"Hanoi": "VN", "Monaco": "MC"}

# Name, country, latitude, longitude, altitude: what the map leaves out.
MORE = """
Prague,CZ,50.0755,14.4378,200|Brno,CZ,49.20,16.61,237|Ostrava,CZ,49.84,18.28,230
Plzen,CZ,49.75,13.38,310|Bratislava,SK,48.15,17.11,140|Kosice,SK,48.72,21.26,208
Berlin,DE,52.52,13.40,35|Munich,DE,48.14,11.58,520|Hamburg,DE,53.55,9.99,6
Frankfurt,DE,50.11,8.68,112|Cologne,DE,50.94,6.96,53|Dresden,DE,51.05,13.74,113
Leipzig,DE,51.34,12.37,113|Stuttgart,DE,48.78,9.18,245|Salzburg,AT,47.80,13.05,424
Graz,AT,47.07,15.44,353|Innsbruck,AT,47.27,11.40,574|Zurich,CH,47.37,8.54,408
Geneva,CH,46.20,6.14,375|Milan,IT,45.46,9.19,120|Naples,IT,40.85,14.27,17
Florence,IT,43.77,11.26,50|Venice,IT,45.44,12.32,1|Turin,IT,45.07,7.69,239
Palermo,IT,38.12,13.36,14|Barcelona,ES,41.39,2.17,12|Seville,ES,37.39,-5.99,7
Valencia,ES,39.47,-0.38,15|Granada,ES,37.18,-3.60,738|Porto,PT,41.15,-8.61,104
Funchal,PT,32.65,-16.91,10|Lyon,FR,45.76,4.84,173|Marseille,FR,43.30,5.37,12
Bordeaux,FR,44.84,-0.58,16|Nice,FR,43.70,7.27,10|Strasbourg,FR,48.57,7.75,142
Toulouse,FR,43.60,1.44,146|Manchester,GB,53.48,-2.24,38|Edinburgh,GB,55.95,-3.19,47
Glasgow,GB,55.86,-4.25,40|Birmingham,GB,52.48,-1.90,140|Lerwick,GB,60.15,-1.15,10
Cork,IE,51.90,-8.47,10|Rotterdam,NL,51.92,4.48,0|Antwerp,BE,51.22,4.40,8
Bergen,NO,60.39,5.32,12|Tromso,NO,69.65,18.96,10|Trondheim,NO,63.43,10.40,10
Longyearbyen,SJ,78.22,15.65,10|Gothenburg,SE,57.71,11.97,12|Kiruna,SE,67.86,20.23,530
Rovaniemi,FI,66.50,25.73,80|Tampere,FI,61.50,23.76,114|Aarhus,DK,56.16,10.20,10
Torshavn,FO,62.01,-6.77,20|Krakow,PL,50.06,19.94,219|Gdansk,PL,54.35,18.65,7
Wroclaw,PL,51.11,17.03,111|Lviv,UA,49.84,24.03,296|Odesa,UA,46.48,30.73,40
Kharkiv,UA,49.99,36.23,152|Cluj-Napoca,RO,46.77,23.60,360|Varna,BG,43.20,27.91,39
Split,HR,43.51,16.44,10|Thessaloniki,GR,40.64,22.94,20|Heraklion,GR,35.34,25.13,30
Istanbul,TR,41.01,28.98,40|Izmir,TR,38.42,27.14,10|Saint Petersburg,RU,59.93,30.34,10
Murmansk,RU,68.97,33.07,50|Novosibirsk,RU,55.03,82.92,150|Yekaterinburg,RU,56.84,60.61,255
Irkutsk,RU,52.29,104.28,440|Yakutsk,RU,62.03,129.73,100|Vladivostok,RU,43.12,131.89,40
Kazan,RU,55.80,49.11,60|Almaty,KZ,43.24,76.95,850|Samarkand,UZ,39.65,66.96,705
Isfahan,IR,32.65,51.67,1570|Mashhad,IR,36.30,59.61,990|Jeddah,SA,21.54,39.17,12
Dubai,AE,25.20,55.27,5|Tel Aviv,IL,32.09,34.78,20|Alexandria,EG,31.20,29.92,5
Luxor,EG,25.69,32.64,76|Marrakesh,MA,31.63,-8.01,466|Casablanca,MA,33.57,-7.59,27
Lagos,NG,6.52,3.38,10|Kano,NG,12.00,8.52,480|Mombasa,KE,-4.04,39.67,17
Arusha,TZ,-3.37,36.68,1400|Zanzibar,TZ,-6.16,39.19,15|Durban,ZA,-29.86,31.02,10
Cape Town,ZA,-33.92,18.42,20|Johannesburg,ZA,-26.20,28.05,1750|Saint-Denis,RE,-20.88,55.45,20
Karachi,PK,24.86,67.00,10|Lahore,PK,31.55,74.34,217|Mumbai,IN,19.08,72.88,14
Chennai,IN,13.08,80.27,7|Kolkata,IN,22.57,88.36,9|Bangalore,IN,12.97,77.59,920
Hyderabad,IN,17.39,78.49,540|Leh,IN,34.15,77.58,3500|Jaipur,IN,26.91,75.79,431
Chittagong,BD,22.36,91.78,29|Mandalay,MM,21.96,96.09,76|Chiang Mai,TH,18.79,98.98,310
Ho Chi Minh City,VN,10.82,106.63,19|Surabaya,ID,-7.26,112.75,5|Denpasar,ID,-8.67,115.21,4
Makassar,ID,-5.15,119.43,5|Cebu,PH,10.32,123.89,17|Hong Kong,HK,22.32,114.17,10
Shanghai,CN,31.23,121.47,4|Guangzhou,CN,23.13,113.26,21|Chengdu,CN,30.57,104.07,500
Xi'an,CN,34.34,108.94,405|Lhasa,CN,29.65,91.14,3650|Urumqi,CN,43.83,87.62,800
Harbin,CN,45.80,126.53,150|Wuhan,CN,30.59,114.31,37|Osaka,JP,34.69,135.50,5
Kyoto,JP,35.01,135.77,50|Sapporo,JP,43.06,141.35,29|Fukuoka,JP,33.59,130.40,5
Naha,JP,26.21,127.68,10|Busan,KR,35.18,129.08,20|Sydney,AU,-33.87,151.21,20
Melbourne,AU,-37.81,144.96,31|Brisbane,AU,-27.47,153.03,28|Perth,AU,-31.95,115.86,20
Adelaide,AU,-34.93,138.60,50|Darwin,AU,-12.46,130.84,30|Hobart,AU,-42.88,147.33,17
Alice Springs,AU,-23.70,133.88,545|Auckland,NZ,-36.85,174.76,20|Christchurch,NZ,-43.53,172.64,20
Queenstown,NZ,-45.03,168.66,330|Honolulu,US,21.31,-157.86,6|Anchorage,US,61.22,-149.90,31
Fairbanks,US,64.84,-147.72,136|Seattle,US,47.61,-122.33,50|Portland,US,45.52,-122.68,15
San Francisco,US,37.77,-122.42,16|Los Angeles,US,34.05,-118.24,90|San Diego,US,32.72,-117.16,20
Las Vegas,US,36.17,-115.14,610|Phoenix,US,33.45,-112.07,331|Salt Lake City,US,40.76,-111.89,1290
Denver,US,39.74,-104.99,1610|Boulder,US,40.01,-105.27,1655|Albuquerque,US,35.08,-106.65,1620
Dallas,US,32.78,-96.80,131|Houston,US,29.76,-95.37,15|Austin,US,30.27,-97.74,150
New Orleans,US,29.95,-90.07,1|Chicago,US,41.88,-87.63,180|Minneapolis,US,44.98,-93.27,253
Detroit,US,42.33,-83.05,183|Atlanta,US,33.75,-84.39,320|Miami,US,25.76,-80.19,2
Boston,US,42.36,-71.06,14|New York,US,40.71,-74.01,10|Philadelphia,US,39.95,-75.17,12
Vancouver,CA,49.28,-123.12,20|Calgary,CA,51.05,-114.07,1045|Edmonton,CA,53.55,-113.49,645
Winnipeg,CA,49.90,-97.14,239|Toronto,CA,43.65,-79.38,76|Montreal,CA,45.50,-73.57,36
Quebec City,CA,46.81,-71.21,98|Halifax,CA,44.65,-63.58,20|Yellowknife,CA,62.45,-114.37,206
Iqaluit,CA,63.75,-68.52,34|Guadalajara,MX,20.66,-103.35,1566|Monterrey,MX,25.69,-100.32,540
Cancun,MX,21.16,-86.85,10|Cusco,PE,-13.53,-71.97,3400|Medellin,CO,6.24,-75.58,1495
Cali,CO,3.45,-76.53,1018|Guayaquil,EC,-2.19,-79.89,4|Manaus,BR,-3.12,-60.02,92
Recife,BR,-8.05,-34.88,4|Salvador,BR,-12.97,-38.50,8|Rio de Janeiro,BR,-22.91,-43.17,5
Sao Paulo,BR,-23.55,-46.63,760|Belo Horizonte,BR,-19.92,-43.94,850
Porto Alegre,BR,-30.03,-51.23,10|Cordoba,AR,-31.42,-64.18,390|Mendoza,AR,-32.89,-68.84,750
Ushuaia,AR,-54.80,-68.30,23|San Pedro de Atacama,CL,-22.91,-68.20,2408
Punta Arenas,CL,-53.16,-70.91,34|Hanga Roa,CL,-27.15,-109.43,20|Papeete,PF,-17.54,-149.57,5
Noumea,NC,-22.27,166.46,10|Nuuk,GL,64.18,-51.72,5|Stanley,FK,-51.70,-57.85,20
Amundsen-Scott South Pole,AQ,-90.0,0.0,2835|McMurdo,AQ,-77.85,166.67,24
"""


def main(wheel: str) -> None:
    """Write both files."""
    DATA.mkdir(exist_ok=True)
    with zipfile.ZipFile(wheel) as archive:
        rings = [ring for ring in rings_of(archive.read(LAND)) if len(ring) > 3]
        names = names_of(archive.read(f"{CITIES}.dbf"))
        places = points_of(archive.read(f"{CITIES}.shp"))
    np.savez_compressed(
        OUTLINE,
        points=np.round(np.concatenate(rings) * PER_DEGREE).astype(np.int16),
        lengths=np.array([len(ring) for ring in rings], np.int32),
    )
    cities: dict[str, tuple[str, str, float, float, float]] = {}
    for name, (longitude_deg, latitude_deg) in zip(names, places, strict=True):
        name = RENAMED.get(name, name)
        country = COUNTRIES.get(name) or country_at(longitude_deg, latitude_deg)
        altitude_m = float(ALTITUDES.get(plain(name), 0))
        cities[plain(name)] = (name, country, latitude_deg, longitude_deg, altitude_m)
    for line in MORE.replace("\n", "|").split("|"):
        if line:
            name, country, *numbers = line.split(",")
            latitude_deg, longitude_deg, altitude_m = (float(number) for number in numbers)
            cities[name] = (name, country, latitude_deg, longitude_deg, altitude_m)
    with (DATA / "cities.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["name", "country", "latitude_deg", "longitude_deg", "altitude_m"])
        for _, (name, country, latitude, longitude, altitude) in sorted(cities.items()):
            writer.writerow([name, country, f"{latitude:.4f}", f"{longitude:.4f}", f"{altitude:g}"])


def rings_of(shapes: bytes) -> Iterator[NDArray[np.float64]]:
    """Rings (n, 2) of longitude and latitude of a shapefile of polygons."""
    for record in records_of(shapes):
        parts, points = struct.unpack("<ii", record[36:44])
        starts = [*struct.unpack(f"<{parts}i", record[44 : 44 + 4 * parts]), points]
        values = np.frombuffer(record[44 + 4 * parts :], "<f8").reshape(points, 2)
        for start, end in pairwise(starts):
            yield values[start:end]


def points_of(shapes: bytes) -> list[tuple[float, float]]:
    """Longitude and latitude of a shapefile of points."""
    return [struct.unpack("<dd", record[4:20]) for record in records_of(shapes)]


def records_of(shapes: bytes) -> Iterator[bytes]:
    """The contents of a shapefile's records (ESRI 1998)."""
    at = 100
    while at < len(shapes):
        (words,) = struct.unpack(">i", shapes[at + 4 : at + 8])
        yield shapes[at + 8 : at + 8 + 2 * words]
        at += 8 + 2 * words


def names_of(table: bytes) -> list[str]:
    """The one column of a dBase table."""
    count, header, width = struct.unpack("<IHH", table[4:12])
    rows = (table[header + i * width :][1:width] for i in range(count))
    return [row.decode("latin-1").strip() for row in rows]


def country_at(longitude_deg: float, latitude_deg: float) -> str:
    """The two letters of the country whose time zone it is."""
    zone = tzfpy.get_tz(longitude_deg, latitude_deg)
    return next((code for code, name in zones() if name == zone), "")


def zones() -> list[tuple[str, str]]:
    """Country and zone, as the time zone database lists them."""
    lines = (files("tzdata") / "zoneinfo" / "zone.tab").read_text().splitlines()
    rows = [line.split("\t") for line in lines if line and not line.startswith("#")]
    return [(row[0], row[2]) for row in rows]


def plain(name: str) -> str:
    """Without accents."""
    return unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()


if __name__ == "__main__":
    main(sys.argv[1])
