"""Equirectangular pictures: their geometry for one eye and for two, seams, XMP, and refusals."""

import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh
from click.testing import CliRunner
from PIL import Image

from vrut_lite.commands.render import render
from vrut_lite.errors import UserError
from vrut_lite.geometry.colour import luminance
from vrut_lite.geometry.cube_map import major_face
from vrut_lite.geometry.panorama import lat_long_directions
from vrut_lite.messages.camera import pixel_rays
from vrut_lite.project import Project
from vrut_lite.studio.panorama_pictures import PanoramaPlan, PanoramaShot
from vrut_lite.studio.panorama_views import INTERPUPILLARY_M, Sphere

ROOM = str(Path(__file__).parents[1] / "scenes" / "work" / "room.glb")
GPANO = "{http://ns.google.com/photos/1.0/panorama/}"
AROUND = ("--projection", "equirectangular")
EYE_M = np.array([0.3, 1.6, -0.2])


def drawn(sphere, eye, radiance_of):
    """The panorama of an analytic world: radiance (..., 3) from the eye (3,) along rays."""
    picture = np.full((sphere.height_px, sphere.width_px, 3), np.nan, np.float32)
    for view in sphere.views(EYE_M, eye):
        width, height = view.size_px
        x, y = np.meshgrid(np.arange(width), np.arange(height))
        rays = pixel_rays(view.camera, view.size_px, x, y)
        seen = radiance_of(np.array(view.camera.eye_m), rays)
        sphere.fill(picture, view, seen.astype(np.float32))
    return picture


@pytest.mark.parametrize("eye", ["middle", "left", "right"])
def test_every_pixel_shows_its_direction(eye):
    """North in the middle, east right of it, zenith on top, with the scene turned by 0.4 rad.

    A world as bright as the direction's own coordinates: no pixel is left out, and straight lines
    go on from view to view.
    """
    sphere = Sphere(96, 0.4)
    picture = drawn(sphere, eye, lambda _, rays: rays)
    np.testing.assert_allclose(picture, lat_long_directions(48, 0.4), atol=2e-3)


@pytest.mark.parametrize(("distance_m", "azimuth_rad"), [(0.5, 0.3), (2.0, -2.1)])
def test_disparity_is_that_of_eyes_on_a_circle(distance_m, azimuth_rad):
    """A pole appears at azimuth + asin(r / D) to the left eye, - asin(r / D) to the right one.

    r is half of 64 mm. A strip's columns share an eye, which moves edges by a quarter of a pixel.
    """
    sphere = Sphere(2048, 0.0)
    pole_m = EYE_M + distance_m * np.array([math.sin(azimuth_rad), 0.0, -math.cos(azimuth_rad)])
    half_rad = 0.02

    def radiance(eye_m, rays):
        to_pole = (pole_m - eye_m)[[0, 2]]
        across = rays[..., 0] * to_pole[1] - rays[..., 2] * to_pole[0]
        along = rays[..., [0, 2]] @ to_pole
        return np.repeat(((np.arctan2(np.abs(across), along) < half_rad) * 1.0)[..., None], 3, -1)

    column = (azimuth_rad / np.pi + 1.0) * 1024
    for eye, side in (("left", 1.0), ("right", -1.0)):
        horizon = np.zeros((1024, 2048, 3), np.float32)
        for view in sphere.views(EYE_M, eye):
            if abs(0.5 * sum(view.columns) - column) < 60 and view.rows[0] == 0:
                x, y = np.meshgrid(*map(np.arange, view.size_px))
                rays = pixel_rays(view.camera, view.size_px, x, y)
                seen = radiance(np.array(view.camera.eye_m), rays).astype(np.float32)
                sphere.fill(horizon, view._replace(rows=(500, 512)), seen)
        weight = horizon[510, :, 0]
        found = np.sum(weight * (np.arange(2048) + 0.5)) / np.sum(weight)
        moved = side * math.asin(0.5 * INTERPUPILLARY_M / distance_m) / np.pi * 1024
        assert found - column == pytest.approx(moved, abs=0.3)


def steps(picture):
    """Second differences of luminance (stops) at borders of cube faces, and within 8 pixels."""
    face = major_face(lat_long_directions(len(picture)))
    stops = np.log2(luminance(picture))
    at_border, near = [], []
    for axis in (0, 1):
        light, number = np.moveaxis(stops, axis, 0), np.moveaxis(face, axis, 0)
        slope = np.diff(light, axis=0)
        step = np.abs(slope[2:-2] - 0.5 * (slope[:-4] + slope[4:]))
        border = (np.diff(number, axis=0) != 0)[2:-2]
        around = np.zeros_like(border)
        for shift in range(-8, 9):
            around |= np.roll(border, shift, axis=0)
        at_border.append(step[border])
        near.append(step[around & ~border])
    return np.concatenate(at_border), np.concatenate(near)


@pytest.mark.gl
def test_a_room_has_no_seams_and_says_what_it_is(tmp_path):
    """Between faces light steps no more than beside them; viewers find the projection in XMP."""
    import OpenEXR

    where = ("--eye", "0.5,1.5,0.4", "--target", "1.5,1.5,0.4")
    for name in ("a.exr", "a.jpg", "a.png"):
        path = str(tmp_path / name)
        arguments = [ROOM, "-o", path, *AROUND, *where, "--at", "2026-06-21T12:30"]
        result = CliRunner().invoke(
            render, [*arguments, "--size", "256x128"], standalone_mode=False
        )
        assert result.exception is None, result.exception
    with OpenEXR.File(str(tmp_path / "a.exr")) as file:
        picture = np.array(file.channels()["RGB"].pixels)
        assert file.header()["projection"].startswith("equirectangular")
    assert picture.shape == (128, 256, 3)
    assert (picture > 0.0).all()
    at_border, near = steps(picture)
    for share in (0.5, 0.75, 0.9):
        assert np.quantile(at_border, share) < 1.5 * np.quantile(near, share) + 1e-3
    for name, key in (("a.jpg", "xmp"), ("a.png", "XML:com.adobe.xmp")):
        facts = gpano(Image.open(tmp_path / name).info[key])
        assert facts["ProjectionType"] == "equirectangular"
        assert (facts["FullPanoWidthPixels"], facts["FullPanoHeightPixels"]) == ("256", "128")
        # The centre is north, viewers begin where the camera looks: east.
        assert (facts["PoseHeadingDegrees"], facts["InitialViewHeadingDegrees"]) == ("0.0", "90")
        assert "StereoMode" not in facts


def gpano(packet):
    """GPano's values of an XMP packet."""
    text = packet.decode() if isinstance(packet, bytes) else packet
    (about,) = ElementTree.fromstring(text.strip("\ufeff")).iter(
        "{http://www.w3.org/1999/02/22-rdf-syntax-ns#}Description"
    )
    return {key.removeprefix(GPANO): value for key, value in about.items() if GPANO in key}


@pytest.mark.long
@pytest.mark.gl
def test_two_eyes_see_a_near_pole_apart(tmp_path):
    """Top and bottom of one square file: a pole half a metre away lies 2 asin(r / D) apart."""
    pole = trimesh.creation.box((0.06, 4.0, 0.06))
    pole.apply_translation((0.0, 1.0, -0.5))
    material = trimesh.visual.material.PBRMaterial(baseColorFactor=[0, 0, 0, 255])
    pole.visual = trimesh.visual.TextureVisuals(material=material)
    pole.export(tmp_path / "pole.glb")
    arguments = [str(tmp_path / "pole.glb"), "-o", str(tmp_path / "p.png"), *AROUND, "--stereo"]
    arguments += ["--eye", "0,1,0", "--target", "0,1,-1", "--size", "128x128", "--bits", "16"]
    result = CliRunner().invoke(render, arguments, standalone_mode=False)
    assert result.exception is None, result.exception
    image = Image.open(tmp_path / "p.png")
    assert gpano(image.info["XML:com.adobe.xmp"])["StereoMode"] == "top-bottom"
    assert image.text["stereo"] == "omnidirectional, top-bottom, left eye on top"
    found = []
    for row in (31, 64 + 31):
        sky = np.asarray(image.convert("RGB"), float)[row, :, 2]
        dark = np.clip(1.0 - sky / np.median(sky), 0.0, 1.0)
        dark[dark < 0.15] = 0.0
        found.append(np.sum(dark * (np.arange(128) + 0.5)) / np.sum(dark))
    apart = 2.0 * math.asin(0.5 * INTERPUPILLARY_M / 0.5) / (2.0 * np.pi) * 128
    assert found[0] - found[1] == pytest.approx(apart, abs=0.3)
    assert np.mean(found) == pytest.approx(64.0, abs=0.3)


def test_display_goes_on_behind_the_border(tmp_path):
    """By moonlight an eye's acuity blurs: a panorama turned by some columns is the same picture."""
    random = np.random.default_rng(3)
    radiance = (1e-5 * random.random((32, 64, 3))).astype(np.float32)
    plan = PanoramaPlan(Project(scene="x", size=(64, 32)), stereo=False, bits=16)
    shown = []
    for turned in (0, 20):
        path = tmp_path / f"{turned}.png"
        picture = np.roll(radiance, turned, axis=1)
        PanoramaShot(picture, -4.0, {}, plan, b"", ()).write(path)
        shown.append(np.asarray(Image.open(path), int))
    assert shown[0].std() > 1.0
    assert np.array_equal(np.roll(shown[0], 20, axis=1), shown[1])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--stereo",), "--stereo needs --projection equirectangular"),
        ((*AROUND, "--fov", "60"), "--fov is for perspective pictures"),
        ((*AROUND, "--size", "640x480"), "twice as wide as high: 640x480 is not, 2048x1024 is"),
        ((*AROUND, "--stereo", "--size", "640x320"), "square, an eye above the other"),
        ((*AROUND, "--size", "16000x8000"), "32 to 8192 pixels wide"),
        ((*AROUND, "--size", "34x17"), "a multiple of 4"),
        ((*AROUND, "--glare", "0.5"), "has no glare"),
        ((*AROUND, "--polariser", "10"), "has no polariser"),
        ((*AROUND, "--show", "illuminance"), "has no false colours"),
        ((*AROUND, "--engine", "path-tracer"), "is for OpenGL"),
    ],
)
def test_what_no_panorama_can_be_is_refused_in_a_sentence(tmp_path, arguments, words):
    """Before the scene is opened."""
    path = tmp_path / "picture.png"
    result = CliRunner().invoke(render, [ROOM, "-o", str(path), *arguments], standalone_mode=False)
    assert isinstance(result.exception, UserError)
    assert words in str(result.exception)
    assert not path.exists()
