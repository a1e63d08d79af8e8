"""Shaders put together from files, and the numbers that they share with Python."""

import re

import pytest
from bruneton_sky.path_kernels import ERFCX
from bruneton_sky.published.gpu_single_scattering import MOST_ABSORBER_NODES, MOST_GAUSS_NODES

from vrut_lite.sky.shader_text import expand_includes, shader_source

REFERENCE = "bruneton_sky.published"


def test_includes_are_replaced_each_file_once() -> None:
    """A second mention would define everything twice; the first stands where it is named."""
    text = '// mine\n#include "ray.glsl"\n#include "ray.glsl"\nvoid main() {}\n'
    source = expand_includes(text, REFERENCE)
    assert "#include" not in source
    assert source.count("struct Ray {") == 1
    assert source.index("// mine") < source.index("struct Ray {") < source.index("void main()")


def test_nested_includes_keep_the_version_first() -> None:
    """GLSL wants #version on the first line, whatever is included below it."""
    source = shader_source("single_scattering_cube.comp", REFERENCE)
    assert source.startswith("#version 430\n")
    assert "#include" not in source
    assert source.count("uniform float ground_radius_m;") == 1


def test_missing_include_is_refused_by_name() -> None:
    """A misspelt file is not silently left out."""
    with pytest.raises(FileNotFoundError, match=r"no_such\.glsl"):
        expand_includes('#include "no_such.glsl"\n')


def test_erfcx_has_the_kernels_coefficients() -> None:
    """One polynomial in two languages: Horner's order is the constants' order turned round."""
    source = expand_includes('#include "optical_path.glsl"\n', REFERENCE)
    body = source[source.index("vec2 erfcx(") : source.index("return p / (1.0 + 2.0 * x)")]
    first = re.findall(r"vec2\((-?\d\.\d+)\)", body)
    rest = re.findall(r"p \* t ([+-]) (\d\.\d+)", body)
    numbers = [float(first[0]), *(float(sign + digits) for sign, digits in rest)]
    assert tuple(reversed(numbers)) == ERFCX


def test_arrays_are_as_long_as_python_fills_them() -> None:
    """OpenGL takes a uniform array only at its declared length."""
    source = shader_source("single_scattering_cube.comp", REFERENCE)
    assert f"MOST_GAUSS_NODES = {MOST_GAUSS_NODES};" in source
    assert f"MOST_ABSORBER_NODES = {MOST_ABSORBER_NODES};" in source
