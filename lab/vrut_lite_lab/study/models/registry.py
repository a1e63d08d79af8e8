"""The models by name; each call makes a new one, which is cheap."""

from collections.abc import Callable
from functools import partial
from types import MappingProxyType

from vrut_lite_lab.study.models.bruneton import Bruneton
from vrut_lite_lab.study.models.converged import Converged
from vrut_lite_lab.study.models.elek import Elek
from vrut_lite_lab.study.models.haber import Haber
from vrut_lite_lab.study.models.hosek_wilkie import HosekWilkie
from vrut_lite_lab.study.models.measured_aerosol import MeasuredAerosol
from vrut_lite_lab.study.models.model import SkyModel
from vrut_lite_lab.study.models.nishita93 import Nishita93
from vrut_lite_lab.study.models.nishita96 import Nishita96
from vrut_lite_lab.study.models.oneil import ONeil
from vrut_lite_lab.study.models.preetham import Preetham
from vrut_lite_lab.study.models.rules import converged

MODELS: MappingProxyType[str, Callable[[], SkyModel]] = MappingProxyType(
    {
        "preetham": Preetham,
        "oneil": ONeil,
        "hosek-wilkie": HosekWilkie,
        "nishita93": Nishita93,
        "nishita96": Nishita96,
        "nishita96-published": partial(Nishita96, quirks=True),
        "haber": Haber,
        "haber-published": partial(Haber, quirks=True),
        "elek": Elek,
        "bruneton": Bruneton,
        "single-scattering": converged,
        "converged": Converged,
        "measured-aerosol": MeasuredAerosol,
    }
)
