"""Traces a tiny picture with llvm_ad_rgb and ends well, or does not: `python -m path_tracer.probe`.

The library is that of the variable DRJIT_LIBLLVM_PATH.
"""

import sys

import mitsuba


def main() -> int:
    """0 if the picture is as it should be."""
    mitsuba.set_variant("llvm_ad_rgb")
    scene = mitsuba.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 2},
            "sensor": {"type": "perspective", "film": {"type": "hdrfilm", "width": 4, "height": 4}},
            "sky": {"type": "constant", "radiance": {"type": "rgb", "value": 2.0}},
        }
    )
    picture = mitsuba.render(scene, spp=1).numpy()
    return 0 if abs(float(picture.mean()) - 2.0) < 1e-3 else 1


if __name__ == "__main__":
    sys.exit(main())
