"""A page of a room, written by the command and opened by Chromium from disk."""

import base64
import io
import re

import numpy as np
import pytest
from browser import Browser, chromium
from PIL import Image


@pytest.mark.long
def test_the_light_of_a_page_is_that_of_the_scene(written):
    """By day to 3 % rms of its mean, as printed: interpolation, basis and bytes together."""
    path, output = written
    assert path.stat().st_size < 15e6
    lines = re.findall(r"sun (-?[\d.]+) deg: mean ([\d.,]+).* rms ([\d.]+)%", output)
    assert len(lines) == 12
    by_day = [float(rms) for height, _, rms in lines if float(height) > 5.0]
    assert len(by_day) > 5
    assert max(by_day) < 3.0
    assert np.isfinite([float(rms) for *_, rms in lines]).all()


@pytest.mark.long
def test_a_browser_opens_a_page_at_the_hour_of_its_link(written, tmp_path):
    """From disk, by WebGL2 of a processor: clock, sun and exposure are there, and no message."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        browser.open(f"{written[0].as_uri()}#2026-12-21T15:00")

        def text(name):
            return browser.value(f"document.getElementById('{name}').textContent")

        assert text("clock") == "15:00"
        assert text("date") == "21 December"
        assert re.fullmatch(r"sun \d+\.\d° high", text("sun"))
        assert re.fullmatch(r"EV -?\d+\.\d", text("ev"))
        assert browser.value("document.getElementById('message').hidden")
        # No headset is there.
        assert browser.value("document.getElementById('headset').hidden")
        assert browser.errors == []
    finally:
        browser.close()


@pytest.mark.long
def test_the_first_picture_is_shown_before_the_next_is_drawn(written, tmp_path):
    """The next picture's programs take as long again. The browser here lacks the quick decoder of
    base64, as older ones do."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        script = """
            delete Uint8Array.fromBase64;
            document.addEventListener('DOMContentLoaded', () => {
                new MutationObserver(() => requestAnimationFrame(() => {
                    window.framesFirst ??= window.daylight.frames;
                })).observe(document.body, { attributeFilter: ['class'] });
            });
        """
        browser._call("Page.addScriptToEvaluateOnNewDocument", source=script)
        browser.open(f"{written[0].as_uri()}#2026-06-21T12:30")
        browser.until("window.daylight.frames > 1")
        assert browser.value("window.framesFirst") == 1
        # The day's colours are drawn with the next picture.
        assert browser.value("window.daylight.barDay === window.daylight.day")
        assert browser.errors == []
    finally:
        browser.close()


@pytest.mark.long
@pytest.mark.parametrize("at", ["2026-06-21T12:30", "2026-06-21T22:00"], ids=["noon", "dusk"])
@pytest.mark.parametrize("still", ["false", "true"], ids=["moving", "finished"])
def test_lux_has_the_colours_of_its_scale(at, still, written, tmp_path):
    """Brighter places have higher colours, whether thousands of lux or a few: by day all surfaces
    once had the highest."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        browser.open(f"{written[0].as_uri()}#{at}")
        script = f"""(() => {{
            const page = window.daylight, {{ view, canvas }} = page;
            page.showValues();
            page.frame = () => {{}};
            // The ground north of the house, in its shadow and in the sun.
            view.camera.position.set(0, 7, -9);
            view.camera.lookAt(0, 0, -4);
            view.camera.updateMatrixWorld(true);
            page.change();
            page.step();
            // A finished picture begins with a draft.
            for (let k = 0; k < 3; ++k) view.draw({still});
            view.meterValues();
            const url = canvas.toDataURL(), box = canvas.getBoundingClientRect(), found = [];
            for (let j = 1; j < 12; ++j) {{
                for (let i = 1; i < 16; ++i) {{
                    const x = i / 16, y = j / 12;
                    found.push([x, y, view.points.byMap(x * box.width, y * box.height)]);
                }}
            }}
            return [url, view.range, found];
        }})()"""
        url, (low, high), found = browser.value(script)
        pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(url.partition(",")[2]))))
        height, width = pixels.shape[:2]
        share, green = np.array(
            [
                (np.log(lux / low) / np.log(high / low), pixels[int(y * height), int(x * width), 1])
                for x, y, lux in found
                if lux is not None and low < lux < high
            ]
        ).T
        assert len(share) > 50
        assert share.max() - share.min() > 0.2
        # The scale's green grows all the way, from 1 to 231.
        darker = share < 0.5 * (share.min() + share.max())
        assert np.median(green[darker]) < np.median(green[~darker]) - 20
        assert browser.errors == []
    finally:
        browser.close()


@pytest.mark.long
def test_light_gathered_in_the_open_is_that_of_sky_sun_and_ground(written, tmp_path):
    """High above the scene, on planes of all slopes, half a cube of pictures sums to the integral
    over the sky's table, and the picture of the sun's disc to its irradiance: form factors,
    directions, limb darkening and the ground below."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        browser.open(f"{written[0].as_uri()}#2026-06-21T17:00")
        script = """(() => {
            const page = window.daylight, { view } = page, { open } = view;
            page.frame = () => {};
            page.lightHour(false);
            const found = [], point = view.camera.position.clone().set(0, 300, 0);
            const scale = view.shared.open_scale.value, key = view.shared.key_irradiance.value;
            for (let k = 0; k < open.normals.length; k += 7) {
                const normal = open.normals[k], cosine = Math.max(normal.dot(view.keyDirection), 0);
                const sky = [0, 1, 2].map((c) => scale * open.values[4 * k + c]);
                const sun = key.toArray().map((v) => v * cosine);
                found.push([sky, sun, view.points.irradiance(point, normal, normal)]);
            }
            return found;
        })()"""
        sky, sun, gathered = np.array(browser.value(script)).transpose(1, 0, 2)
        assert len(sky) > 20
        assert sky[:, 1].max() > 3.0 * sky[:, 1].min()
        assert sun[:, 1].max() > sky[:, 1].max()
        assert gathered == pytest.approx(sky + sun, rel=0.02)
        assert browser.errors == []
    finally:
        browser.close()


@pytest.mark.long
def test_a_resting_pointer_reads_lux_by_all_that_is_seen_from_its_place(written, tmp_path):
    """First the light map's, said to be about right; then, on open ground, sky and sun exactly."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        browser.open(f"{written[0].as_uri()}#2026-06-21T17:00")
        first, by_sky = browser.value("""(() => {
            const page = window.daylight, { view, canvas } = page, { shared } = view;
            page.frame = () => {};
            view.camera.position.set(0, 3, 60);
            view.camera.lookAt(0, 0, 61);
            view.camera.updateMatrixWorld(true);
            page.dragging = false;
            page.change();
            page.step();
            const box = canvas.getBoundingClientRect();
            const { open_up: up, key_irradiance: key } = shared;
            page.pointer = { x: box.width / 2, y: box.height / 2 };
            page.tellLux();
            const level = up.value.clone().addScaledVector(key.value, view.keyDirection.y);
            const lux = 683 * (0.2126 * level.x + 0.7152 * level.y + 0.0722 * level.z);
            return [document.getElementById('lux').textContent, lux];
        })()""")
        assert first.startswith("≈ ")
        browser.until("!document.getElementById('lux').textContent.startsWith('≈')")
        text = browser.value("document.getElementById('lux').textContent")
        assert float(text.removesuffix(" lx").replace(",", "")) == pytest.approx(by_sky, rel=0.02)
        assert browser.errors == []
    finally:
        browser.close()


@pytest.mark.long
def test_numbers_stand_in_the_scene_in_the_colours_of_their_legend(written, tmp_path):
    """A daylight factor is chosen: its scale, tiles, and the number under the pointer."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        browser.open(f"{written[0].as_uri()}#2026-06-21T12:30")
        options = "document.getElementById('numbers').options"
        names = browser.value(f"Array.from({options}, (option) => option.text)")
        assert names == ["numbers", "daylight factor, %", "sun, h"]
        assert browser.value("document.getElementById('legend').hidden")
        script = """(() => {
            const page = window.daylight, { view, canvas } = page;
            page.showNumber(0);
            page.frame = () => {};
            const { camera } = view, box = canvas.getBoundingClientRect();
            camera.position.set(1, 1.6, 0);
            camera.lookAt(1, 0.85, -0.001);
            camera.updateMatrixWorld(true);
            page.change();
            view.draw(false);
            page.pointer = { x: box.width / 2, y: box.height / 2 };
            page.tellLux();
            return [canvas.toDataURL(), document.getElementById('high').textContent,
                document.getElementById('lux').textContent];
        })()"""
        url, high, under = browser.value(script)
        assert high == "8 %"
        assert under == "8 %"
        pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(url.partition(",")[2]))))
        height, width = pixels.shape[:2]
        # The scale's upper end.
        assert pixels[height // 2, width // 2, :3] == pytest.approx([253, 231, 37], abs=6)
        assert browser.errors == []
    finally:
        browser.close()


@pytest.mark.long
def test_a_draft_is_lit_like_a_picture_at_rest(written, tmp_path):
    """The same pixels, whether surfaces are lit as they are drawn or from what a draft keeps of
    them; its exposure by fewer of its pixels is that by more; and texels that a draft leaves out
    are summed when the view turns."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        browser.open(f"{written[0].as_uri()}#2026-06-21T16:00")
        script = """(() => {
            const page = window.daylight, { view } = page, { renderer, coarse } = view;
            page.frame = () => {};
            const radiance = () => {
                const read = new Uint16Array(4 * coarse.width * coarse.height);
                renderer.readRenderTargetPixels(coarse, 0, 0, coarse.width, coarse.height, read);
                return Array.from(read);
            };
            page.dragging = true;
            for (const minute of [958, 959, 960]) { page.setHour(page.day, minute); page.step(); }
            const left = view.light.map.all.length - view.light.map.numbers.length;
            const draft = radiance(), { ev, draftMeter } = view;
            view.draftMeter = view.meter;
            view.meterPicture(coarse, 1 / view.shared.pre.value);
            view.draftMeter = draftMeter;
            const stops = view.ev - ev;
            view.ev = ev;
            view.relit.material.visible = false;
            view.opaque.visible = true;
            renderer.clear();
            renderer.render(view.scene, view.camera);
            view.relit.material.visible = true;
            const forward = radiance();
            view.camera.rotation.y += 0.6;
            page.change();
            page.step();
            const { all, numbers } = view.light.map;
            return [draft, forward, left, numbers.length - all.length, stops];
        })()"""
        draft, forward, left, missing, stops = browser.value(script)
        draft, forward = (
            np.array(one, np.uint16).view(np.float16).reshape(-1, 4)[:, :3].astype(float)
            for one in (draft, forward)
        )
        assert left > 0
        assert missing == 0
        assert abs(stops) < 0.05
        assert forward.mean() > 1e-3
        assert draft.mean() == pytest.approx(forward.mean(), rel=0.01)
        assert np.quantile(np.abs(draft - forward) / forward.mean(), 0.9) < 0.01
        assert browser.errors == []
    finally:
        browser.close()


@pytest.mark.long
def test_a_draft_keeps_a_shadow_map_that_the_sun_has_hardly_left(written, tmp_path):
    """Within half a degree; pictures at rest, and drafts after these or after a time without light,
    have the map of their hour."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        browser.open(f"{written[0].as_uri()}#2026-06-21T12:30")
        script = """(() => {
            const page = window.daylight, { view } = page, drawn = [];
            page.frame = () => {};
            const drawShadow = view.drawShadow.bind(view);
            view.drawShadow = (towards) => {
                drawn.push([page.minute, view.shadow.width, towards.angleTo(view.keyDirection)]);
                drawShadow(towards);
            };
            const light = (minute, draft) => {
                page.setHour(page.day, minute);
                view.setHour(page.date, draft);
            };
            for (const minute of [720, 721, 726, 727]) light(minute, true);
            light(727, false);
            for (const minute of [727, 0, 727]) light(minute, true);
            return drawn;
        })()"""
        drawn = browser.value(script)
        assert [minute for minute, _, _ in drawn] == [720, 726, 727, 727, 0, 727]
        assert [width for _, width, _ in drawn] == [640, 640, 2048, 640, 640, 640]
        assert [apart for _, _, apart in drawn] == pytest.approx([0.0] * 6, abs=1e-6)
        assert browser.errors == []
    finally:
        browser.close()


# Illuminance by the sun alone on the ground about so many lengths of the room's shadow from it,
# as a camera from 14 m above sees it; rows and columns.
SUNLIGHT = """
    const sunlight = (page, lengths, edge) => {
        const { view } = page, { points: { probe }, renderer, shared, camera } = view;
        const { lower, upper, ground_m } = page.header.scene, towards = view.keyDirection;
        const far = lengths * (upper[1] - ground_m) / towards.y;
        const [x, y, z] = [0, 1, 2].map((k) => (k === 1 ? ground_m
            : 0.5 * (lower[k] + upper[k]) - far * towards.getComponent(k)));
        camera.position.set(x, y + 14, z);
        camera.up.set(0, 0, -1);
        camera.lookAt(x, y, z);
        camera.aspect = 1;
        camera.updateProjectionMatrix();
        camera.updateMatrixWorld(true);
        probe.setSize(edge, edge);
        const lux = new Float32Array(4 * edge * edge);
        const seen = () => {
            shared.values_shown.value = 1;
            renderer.setRenderTarget(probe);
            renderer.clear();
            renderer.render(view.scene, camera);
            renderer.readRenderTargetPixels(probe, 0, 0, edge, edge, lux);
            shared.values_shown.value = 0;
            return lux.filter((_, k) => k % 4 === 0);
        };
        const all = seen(), key = shared.key_irradiance.value.clone();
        shared.key_irradiance.value.set(0, 0, 0);
        const others = seen();
        shared.key_irradiance.value.copy(key);
        const by_sun = Array.from(all, (lx, k) => lx - others[k]);
        return Array.from({ length: edge }, (_, row) => by_sun.slice(row * edge, (row + 1) * edge));
    };
"""


def evening(written, tmp_path, script):
    """The result of a script that measures sunlight on the page by a low sun."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        browser.open(f"{written[0].as_uri()}#2026-06-21T19:30")
        found = browser.value(f"""(() => {{
            {SUNLIGHT}
            const page = window.daylight, {{ view }} = page;
            page.frame = () => {{}};
            {script}
        }})()""")
        assert browser.errors == []
        return found
    finally:
        browser.close()


@pytest.mark.long
def test_coarse_texels_of_a_shadow_map_do_not_move_its_shadows(written, tmp_path):
    """A map of 96 texels shades the same places as one of 2048, to half a pixel along edges: a
    look-up before the surface, by as much as a texel, would move them by more than one."""
    script = """
        view.draftShadow.setSize(96, 96);
        return [false, true].map((draft) => {
            view.setHour(page.date, draft);
            return sunlight(page, 1, 160);
        });
    """
    fine, coarse = np.array(evening(written, tmp_path, script))
    sunny = 0.5 * np.quantile(fine, 0.9)
    lit = fine > sunny
    edges = (lit[1:] != lit[:-1]).sum() + (lit[:, 1:] != lit[:, :-1]).sum()
    assert edges > 160
    assert (np.abs(coarse - fine) > sunny).sum() < 0.5 * edges


@pytest.mark.long
def test_a_shadow_goes_on_beyond_the_box_of_the_scene(written, tmp_path):
    """A room's shadow ends on the ground several metres from it, farther from the sun than any of
    its corners, and the ground after it is lit."""
    script = """
        view.setHour(page.date);
        return [0.8, 4].map((lengths) => sunlight(page, lengths, 17)[8][8]);
    """
    shaded, free = evening(written, tmp_path, script)
    assert shaded == pytest.approx(0.0, abs=1.0)
    assert free > 1000.0


@pytest.mark.long
def test_a_night_without_a_moon_has_surfaces_planets_and_the_milky_way(written, tmp_path):
    """Surfaces reflect the glow, the band of the Milky Way turns with the stars, the planets stand
    where their ephemeris has them, and the moon is as large as its distance makes it."""
    if chromium() is None:
        pytest.skip("needs a browser (Debian: chromium)")
    browser = Browser(tmp_path)
    try:
        browser.open(f"{written[0].as_uri()}#2026-08-14T23:30")
        script = """(() => {
            const page = window.daylight, { view } = page;
            const { renderer, coarse, stars, table } = view;
            page.frame = () => {};
            page.dragging = true;
            page.change();
            page.step();
            const read = new Uint16Array(4 * coarse.width * coarse.height);
            view.skyPass.visible = stars.points.visible = false;
            view.drawRadiance(view.camera, coarse);
            renderer.readRenderTargetPixels(coarse, 0, 0, coarse.width, coarse.height, read);
            const up = stars.points.position.clone().set(0, 1, 0);
            const sum = (v) => v[0] + v[1] + v[2];
            const zeniths = [0, 4, 8, 12, 16, 20].map((hour) => {
                page.setHour(page.day, 60 * hour);
                page.lightHour(true);
                return sum(table.glowRadiance(up));
            });
            const planets = Array.from(stars.geometry.getAttribute('light').array.slice(-18));
            page.setHour(357, 30);
            page.lightHour(true);
            const { value } = view.skyPass.material.uniforms.disc_radius;
            return [Array.from(read), renderer.getContext().getError(), zeniths, planets, value];
        })()"""
        read, error, zeniths, planets, radius = browser.value(script)
        surfaces = np.array(read, np.uint16).view(np.float16).reshape(-1, 4)[:, :3]
        assert error == 0
        assert (surfaces.max(axis=1) > 0.0).mean() > 0.5
        assert max(zeniths) > 1.1 * min(zeniths) > 0.0
        light = np.reshape(planets, (6, 3))
        # Venus and Jupiter outshine all stars, Uranus is one that few see.
        assert light[[1, 3], 1].min() > 30.0 * light[5, 1] > 0.0
        # Perigee: 350,950 km from Prague, on the mean 384,400 from the Earth's middle.
        assert radius == pytest.approx(np.arcsin(1737.4 / 350_950.0), rel=0.01)
        assert browser.errors == []
    finally:
        browser.close()
