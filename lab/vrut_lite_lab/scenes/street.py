"""A narrow street of an old town, running north, where little of the sky is seen."""

from dataclasses import dataclass

from vrut_lite_lab.scenes import textures
from vrut_lite_lab.scenes.obj_writer import ObjMaterial, write_obj
from vrut_lite_lab.scenes.shapes import (
    PlainMesh,
    box,
    joined,
    lathe,
    obelisk,
    polygon,
    relief,
    sphere,
)

_FRONT_M = 4.5
_DEPTH_M = 8.0
_STOREY_M = 3.1
_TEXTURE_M = 2.0
_MATERIALS = {
    "brick": ObjMaterial("brick", (0.95, 0.95, 0.95), 2.0, "street_brick.png"),
    "paving": ObjMaterial("paving", (0.95, 0.95, 0.95), 8.0, "street_paving.png"),
    "ochre": ObjMaterial("ochre", (0.60, 0.42, 0.20)),
    "cream": ObjMaterial("cream", (0.72, 0.67, 0.55)),
    "rose": ObjMaterial("rose", (0.56, 0.34, 0.27)),
    "sage": ObjMaterial("sage", (0.38, 0.45, 0.33)),
    "tiles": ObjMaterial("tiles", (0.33, 0.12, 0.07), 4.0),
    "slate": ObjMaterial("slate", (0.09, 0.095, 0.105), 20.0),
    "kerb": ObjMaterial("kerb", (0.42, 0.41, 0.38)),
    "frames": ObjMaterial("frames", (0.76, 0.75, 0.71), 20.0),
    "glass": ObjMaterial("glass", (0.025, 0.03, 0.035), 2000.0),
    "doors": ObjMaterial("doors", (0.12, 0.07, 0.04), 30.0),
    "iron": ObjMaterial("iron", (0.03, 0.03, 0.032), 60.0),
}


@dataclass(frozen=True)
class House:
    """Side of the street (-1 west, +1 east), where it begins in the south, and its looks."""

    side: int
    south_m: float
    width_m: float
    storeys: int
    wall: str
    roof: str


_HOUSES = [
    House(-1, 14.0, 8.0, 3, "cream", "tiles"),
    House(-1, 6.0, 7.0, 4, "brick", "slate"),
    House(-1, -1.0, 8.0, 3, "rose", "tiles"),
    House(-1, -9.0, 7.0, 3, "ochre", "tiles"),
    House(-1, -16.0, 9.0, 4, "brick", "tiles"),
    House(1, 14.0, 7.0, 4, "brick", "tiles"),
    House(1, 7.0, 9.0, 3, "sage", "tiles"),
    House(1, -2.0, 7.0, 3, "cream", "slate"),
    House(1, -9.0, 8.0, 4, "ochre", "tiles"),
    House(1, -17.0, 8.0, 3, "brick", "tiles"),
]


def build() -> dict[str, bytes]:
    """File names and their bytes."""
    parts: dict[str, list[PlainMesh]] = {name: [] for name in _MATERIALS}
    for house in _HOUSES:
        _add_house(parts, house)
    _add_tower(parts)
    _add_ground(parts)
    for z_m in (9.0, -3.0, -15.0):
        parts["iron"].append(_lamp().moved(x=-3.55, z=z_m))
    groups = [(_MATERIALS[name], joined(shapes)) for name, shapes in parts.items()]
    groups = [
        (material, shape.textured_every(_TEXTURE_M) if material.texture else shape)
        for material, shape in groups
    ]
    obj, mtl = write_obj("A street, vrut_lite scenes/build_scenes.py", "street.mtl", groups)
    return {
        "street.obj": obj,
        "street.mtl": mtl,
        "street_brick.png": textures.brick(),
        "street_paving.png": textures.paving(),
    }


def _add_house(parts: dict[str, list[PlainMesh]], house: House) -> None:
    """A house is made to face east with its front on x = 0, then set on its side."""
    turn_deg, north_m = (0.0, house.south_m) if house.side < 0 else (180.0, house.south_m)
    made: dict[str, list[PlainMesh]] = {name: [] for name in parts}
    eaves_m = house.storeys * _STOREY_M + 0.6
    made[house.wall].append(_walls(house.width_m, eaves_m))
    made[house.roof].append(_roof(house.width_m, eaves_m))
    made["brick"].append(
        box(
            (-5.4, eaves_m + 1.0, -house.width_m + 1.0), (-4.7, eaves_m + 4.2, -house.width_m + 1.7)
        )
    )
    _add_openings(made, house)
    for name, shapes in made.items():
        for shape in shapes:
            if house.side > 0:
                shape = shape.moved(z=house.width_m).turned(turn_deg)
            parts[name].append(shape.moved(x=house.side * _FRONT_M, z=north_m))


def _walls(width_m: float, eaves_m: float) -> PlainMesh:
    """Four walls, the sides ending in gables; the south wall on z = 0."""
    ridge_m, back, north = eaves_m + _DEPTH_M * 0.42, -_DEPTH_M, -width_m
    middle = back / 2
    return joined(
        [
            polygon([(0, 0, 0), (0, 0, north), (0, eaves_m, north), (0, eaves_m, 0)]),
            polygon([(back, 0, north), (back, 0, 0), (back, eaves_m, 0), (back, eaves_m, north)]),
            polygon(
                [(back, 0, 0), (0, 0, 0), (0, eaves_m, 0), (middle, ridge_m, 0), (back, eaves_m, 0)]
            ),
            polygon(
                [
                    (0, 0, north),
                    (back, 0, north),
                    (back, eaves_m, north),
                    (middle, ridge_m, north),
                    (0, eaves_m, north),
                ]
            ),
        ]
    )


def _roof(width_m: float, eaves_m: float) -> PlainMesh:
    """Two slabs that overhang the walls by 40 cm, and the boards under their edges."""
    slope, over, thick = 0.84, 0.4, 0.18
    ridge_m, low_m = eaves_m + _DEPTH_M / 2 * slope + 0.02, eaves_m - over * slope + 0.02
    middle, north = -_DEPTH_M / 2, -width_m
    section = [
        (over, low_m),
        (over, low_m + thick),
        (middle, ridge_m + thick),
        (-_DEPTH_M - over, low_m + thick),
        (-_DEPTH_M - over, low_m),
        (middle, ridge_m),
    ]
    sides = [
        polygon([(*a, 0), (*a, north), (*b, north), (*b, 0)])
        for a, b in zip(section, section[1:] + section[:1], strict=True)
    ]
    ends = []
    for half in (section[:3] + section[5:], section[2:5] + section[5:]):
        ends.append(polygon([(x, y, 0) for x, y in half]))
        ends.append(polygon([(x, y, north) for x, y in half[::-1]]))
    return joined(sides + ends)


def _add_openings(made: dict[str, list[PlainMesh]], house: House) -> None:
    columns = round(house.width_m / 2.4)
    pitch_m = house.width_m / columns
    door = columns // 2
    for storey in range(house.storeys):
        for column in range(columns):
            z_m = -(column + 0.5) * pitch_m
            if storey == 0 and column == door:
                made["kerb"].append(relief((-0.1, 0.0, z_m - 0.75), (0.35, 0.14, z_m + 0.75)))
                made["frames"].append(relief((-0.1, 0.14, z_m - 0.7), (0.08, 2.55, z_m + 0.7)))
                made["doors"].append(relief((-0.1, 0.14, z_m - 0.55), (0.11, 2.4, z_m + 0.55)))
            else:
                _add_window(made, storey * _STOREY_M + 1.15, z_m)
    made["kerb"].append(relief((-0.1, 0.0, -house.width_m), (0.06, 0.55, -0.001)))
    made["frames"].append(
        relief(
            (-0.1, house.storeys * _STOREY_M + 0.3, -house.width_m),
            (0.22, house.storeys * _STOREY_M + 0.5, 0.0),
        )
    )


def _add_window(made: dict[str, list[PlainMesh]], sill_m: float, z_m: float) -> None:
    """A frame with a cross of bars, four panes, and a sill that throws a shadow."""
    height_m, half_m = 1.6, 0.52
    made["glass"].append(
        relief((-0.1, sill_m, z_m - half_m), (0.03, sill_m + height_m, z_m + half_m))
    )
    bars = [
        (sill_m, sill_m + height_m, -half_m - 0.1, -half_m),
        (sill_m, sill_m + height_m, half_m, half_m + 0.1),
        (sill_m, sill_m + height_m, -0.03, 0.03),
        (sill_m + 1.0, sill_m + 1.06, -half_m, half_m),
        (sill_m + height_m, sill_m + height_m + 0.12, -half_m - 0.1, half_m + 0.1),
    ]
    for low, high, south, north in bars:
        made["frames"].append(relief((-0.1, low, z_m + south), (0.07, high, z_m + north)))
    made["kerb"].append(
        relief((-0.1, sill_m - 0.12, z_m - half_m - 0.2), (0.2, sill_m, z_m + half_m + 0.2))
    )


def _add_tower(parts: dict[str, list[PlainMesh]]) -> None:
    """A tower with a clock face closes the street in the north."""
    parts["brick"].append(box((-3.6, 0.0, -34.2), (3.6, 17.0, -27.0)))
    parts["kerb"].append(box((-3.8, 17.0, -34.4), (3.8, 17.5, -26.8)))
    parts["slate"].append(obelisk(7.2, 0.9, 6.5, 8.0).moved(y=17.5, z=-30.6))
    parts["frames"].append(box((-1.5, 12.8, -27.0), (1.5, 15.8, -26.85)))
    parts["iron"] += [
        box((-0.06, 14.3, -26.85), (0.06, 15.5, -26.8)),
        box((0.0, 14.24, -26.85), (0.85, 14.36, -26.8)),
    ]
    parts["doors"].append(box((-1.5, 0.0, -27.0), (1.5, 4.2, -26.9)))
    parts["kerb"] += [
        box((-2.0, 0.0, -27.0), (-1.5, 4.7, -26.8)),
        box((1.5, 0.0, -27.0), (2.0, 4.7, -26.8)),
        box((-1.5, 4.2, -27.0), (1.5, 4.7, -26.8)),
    ]
    for side in (-1, 1):
        parts["cream"].append(
            box(
                (min(3.6 * side, 12.5 * side), 0.0, -33.0),
                (max(3.6 * side, 12.5 * side), 9.0, -27.6),
            )
        )
        parts["kerb"].append(
            box(
                (min(3.6 * side, 12.5 * side), 9.0, -33.2),
                (max(3.6 * side, 12.5 * side), 9.4, -27.4),
            )
        )


def _add_ground(parts: dict[str, list[PlainMesh]]) -> None:
    """Setts across the street, and two pavements a step higher."""
    parts["paving"].append(
        polygon([(-13.0, 0.0, 20.0), (13.0, 0.0, 20.0), (13.0, 0.0, -35.0), (-13.0, 0.0, -35.0)])
    )
    for west, east in ((-_FRONT_M, -3.4), (3.4, _FRONT_M)):
        parts["kerb"].append(box((west, 0.0, -25.0), (east, 0.1, 14.0)))


def _lamp() -> PlainMesh:
    post = lathe([(0.14, 0.0), (0.14, 0.25), (0.06, 0.4), (0.045, 3.6)], 10)
    head = [sphere(0.17, 10).moved(y=3.75), box((-0.2, 3.9, -0.2), (0.2, 3.95, 0.2))]
    return joined([post, *head])
