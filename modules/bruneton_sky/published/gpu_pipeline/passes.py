"""Algorithm 1 as a list of passes: shader, textures and slices of each."""

from collections.abc import Iterator
from typing import Any, NamedTuple, Self

from bruneton_sky.published.gpu_pipeline.programs import DENSITY_GROUP, FLAT_GROUP, RAY_GROUP
from bruneton_sky.published.gpu_pipeline.tables import GpuTables, flat_texture, scattering_texture
from bruneton_sky.tables.sizes import TableSizes

# Altitudes of a scattering table per dispatch: short enough for a frame in between.
LAYERS_AT_ONCE = 4


class Workspace(NamedTuple):
    """Textures of one order: used again by the next, and for the next wavelengths."""

    irradiance: Any
    density: Any
    radiance: Any

    @classmethod
    def empty(cls, context: Any, sizes: TableSizes) -> Self:
        """Textures without content."""
        return cls(
            flat_texture(context, sizes.irradiance_altitude, sizes.irradiance_mu_s),
            scattering_texture(context, sizes),
            scattering_texture(context, sizes),
        )


class Pass(NamedTuple):
    """One shader's whole table.

    Attributes:
        shader: its name.
        order: of scattering; 0 for the transmittance.
        results: textures by the names that `run_pipeline` gives its observer.
        images: written textures, by image unit.
        inputs: read textures, by texture unit; None for unused units.
        groups: work groups along x and y.
        layers: along z.
        scattered_once: whether the incoming light is of the first order.
    """

    shader: str
    order: int
    results: dict[str, Any]
    images: tuple[Any, ...]
    inputs: tuple[Any, ...]
    groups: tuple[int, int]
    layers: int = 1
    scattered_once: bool = False

    def dispatches(self, program: Any, air: Any) -> Iterator[None]:
        """Run it slice by slice; other work may use the context between slices.

        Args:
            program: the compiled shader.
            air: the buffer of the atmosphere.
        """
        for first in range(0, self.layers, LAYERS_AT_ONCE):
            air.bind_to_storage_buffer(0)
            for unit, texture in enumerate(self.inputs):
                if texture is not None:
                    texture.use(unit)
            for unit, texture in enumerate(self.images):
                texture.bind_to_image(unit, read=True, write=True)
            _set(program, "first_layer", first)
            _set(program, "scattered_once", self.scattered_once)
            program.run(*self.groups, min(LAYERS_AT_ONCE, self.layers - first))
            yield


def _set(program: Any, name: str, value: int) -> None:
    if name in program:
        program[name].value = value


def passes(sizes: TableSizes, made: GpuTables, work: Workspace, orders: int) -> Iterator[Pass]:
    """All passes in their order."""
    yield from _first_order(sizes, made, work)
    for order in range(2, orders + 1):
        yield from _next_order(sizes, made, work, order)


def _first_order(sizes: TableSizes, made: GpuTables, work: Workspace) -> Iterator[Pass]:
    yield Pass(
        "transmittance",
        0,
        {"optical_depth": made.optical_depth},
        (made.optical_depth,),
        (),
        _groups(FLAT_GROUP, sizes.transmittance_mu, sizes.transmittance_altitude),
    )
    yield Pass(
        "direct_irradiance",
        1,
        {"delta_irradiance": work.irradiance},
        (work.irradiance, made.irradiance),
        (made.optical_depth,),
        _groups(FLAT_GROUP, sizes.irradiance_mu_s, sizes.irradiance_altitude),
    )
    yield Pass(
        "single_scattering",
        1,
        {"single_rayleigh": made.scattering, "single_mie": made.single_mie},
        (made.scattering, made.single_mie),
        (made.optical_depth,),
        (-(-sizes.nu * sizes.mu_s // RAY_GROUP), sizes.mu),
        sizes.altitude,
    )


def _next_order(sizes: TableSizes, made: GpuTables, work: Workspace, order: int) -> Iterator[Pass]:
    # Until the second order is added to it, the sum of all orders is the first.
    once = order == 2
    light = made.scattering if once else work.radiance
    yield Pass(
        "scattering_density",
        order,
        {"scattering_density": work.density},
        (work.density,),
        (made.optical_depth, light, made.single_mie, work.irradiance),
        (-(-sizes.mu * sizes.nu // DENSITY_GROUP), sizes.mu_s),
        sizes.altitude,
        once,
    )
    yield Pass(
        "indirect_irradiance",
        order,
        {"delta_irradiance": work.irradiance},
        (work.irradiance, made.irradiance),
        (None, light, made.single_mie),
        (sizes.irradiance_mu_s, sizes.irradiance_altitude),
        scattered_once=once,
    )
    yield Pass(
        "multiple_scattering",
        order,
        {"delta_multiple_scattering": work.radiance},
        (work.radiance, made.scattering),
        (made.optical_depth, work.density),
        (-(-sizes.nu * sizes.mu_s // RAY_GROUP), sizes.mu),
        sizes.altitude,
    )


def _groups(edge: int, columns: int, rows: int) -> tuple[int, int]:
    return -(-columns // edge), -(-rows // edge)
