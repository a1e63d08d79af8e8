"""UsdPreviewSurface as a `SurfaceMaterial`: its values, and the picture of its diffuse colour."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vrut_lite.messages.scene_content import AlphaMode
from vrut_lite.scene.budget import SceneBudget
from vrut_lite.scene.images import PixelBudget, decode_image
from vrut_lite.scene.import_warnings import Notices
from vrut_lite.scene.materials import SurfaceMaterial, tell_clipped

_MASKED = 0.5
Faces = NDArray[np.int64] | None


class UsdMaterials:
    """The materials of one stage; each is made once."""

    def __init__(self, folder: Path, budget: SceneBudget, notices: Notices, time: Any) -> None:
        self._folder, self._notices, self._time = folder.resolve(), notices, time
        self._pixels = PixelBudget(budget)
        self._made: dict[str, SurfaceMaterial | None] = {}
        self._pictures: dict[str, Image.Image | None] = {}

    def parts(self, prim: Any, faces: int) -> Iterator[tuple[Faces, SurfaceMaterial | None]]:
        """The polygons of each material of a mesh; None for all of them, or for no material."""
        from pxr import UsdGeom

        subsets = UsdGeom.Subset.GetGeomSubsets(
            UsdGeom.Imageable(prim), UsdGeom.Tokens.face, "materialBind"
        )
        left = np.ones(faces, bool)
        for subset in subsets:
            chosen = np.array(subset.GetIndicesAttr().Get(self._time) or [], np.int64)
            chosen = chosen[(chosen >= 0) & (chosen < faces)]
            left[chosen] = False
            yield chosen, self._bound(subset.GetPrim())
        if np.any(left):
            yield np.flatnonzero(left) if subsets else None, self._bound(prim)

    def _bound(self, prim: Any) -> SurfaceMaterial | None:
        from pxr import UsdShade

        material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        key = str(material.GetPath()) if material else ""
        if key not in self._made:
            self._made[key] = self._make(material) if material else None
        return self._made[key]

    def _make(self, material: Any) -> SurfaceMaterial | None:
        shader = material.ComputeSurfaceSource()[0]
        if not shader or shader.GetIdAttr().Get() != "UsdPreviewSurface":
            self._notices.tell(
                "USD material without UsdPreviewSurface", "displayColor or grey instead"
            )
            return None

        def value(name: str, default: Any) -> Any:
            source = shader.GetInput(name)
            found = source.Get(self._time) if source else None
            return default if found is None else found

        image = None
        for source in shader.GetInputs():
            if source.HasConnectedSource():
                name = source.GetBaseName()
                if name == "diffuseColor":
                    image = self._connected(source)
                else:
                    self._notices.tell(f"map of USD's {name}", "left out")
        alpha, cutoff = float(value("opacity", 1.0)), float(value("opacityThreshold", 0.0))
        blended: AlphaMode = "BLEND" if alpha < 1.0 else "OPAQUE"
        colour = [1.0] * 3 if image is not None else value("diffuseColor", (0.18, 0.18, 0.18))
        tell_clipped(
            self._notices,
            diffuseColor=colour,
            opacity=alpha,
            metallic=value("metallic", 0.0),
            roughness=value("roughness", 0.5),
        )
        return SurfaceMaterial(
            name=material.GetPrim().GetName(),
            baseColorFactor=np.array([*colour, alpha]),
            baseColorTexture=image,
            metallicFactor=float(np.clip(value("metallic", 0.0), 0.0, 1.0)),
            roughnessFactor=float(np.clip(value("roughness", 0.5), 0.0, 1.0)),
            emissiveFactor=np.maximum(np.array(value("emissiveColor", (0.0,) * 3)), 0.0),
            alphaMode="MASK" if cutoff > 0.0 else blended,
            alphaCutoff=cutoff or _MASKED,
            doubleSided=True,
        )

    def _connected(self, source: Any) -> Image.Image | None:
        """The picture of a UsdUVTexture."""
        from pxr import Ar, UsdShade

        texture = UsdShade.Shader(source.GetConnectedSources()[0][0].source.GetPrim())
        file = texture.GetInput("file")
        asset = file.Get(self._time) if file else None
        if asset is None or not asset.resolvedPath:
            self._notices.tell(f"picture {getattr(asset, 'path', '')}", "missing, left out")
            return None
        path = asset.resolvedPath
        if path not in self._pictures:
            if not Path(path.partition("[")[0]).resolve().is_relative_to(self._folder):
                self._notices.tell(f"picture {asset.path}", "outside the scene's folder, left out")
                return None
            opened = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
            data, name = bytes(opened.GetBuffer()), ascii(Path(asset.path).name)
            self._pixels.admit(data, name)
            self._pictures[path] = decode_image(data, name)
        return self._pictures[path]
