"""GpuJobs: modules hand shaders to the GL owner, and results come back as inputs."""

from concurrent.futures import wait
from types import SimpleNamespace

import msgspec
import numpy as np
import pytest

from vrut_lite.array import Array
from vrut_lite.geometry.cube_map import texel_directions
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import JobResult
from vrut_lite.kernel.module import Manifest, Module, handles
from vrut_lite.message_codec import arrays_of, decode, to_plain
from vrut_lite.messages.gpu_job import GpuJob, GpuPass, GpuTexture
from vrut_lite.messages.picture import Resize
from vrut_lite.recording.recipes import recipe_of_plain
from vrut_lite.render import texture_pool

pytestmark = pytest.mark.gl
SIZE = 16
# Writes each texel's direction, by the table of the OpenGL specification.
DIRECTIONS = """
#version 430
layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(rgba32f, binding = 0) writeonly uniform imageCube sky;
uniform float scale;
void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    vec2 c = 2.0 * (vec2(at.xy) + 0.5) / vec2(imageSize(sky)) - 1.0;
    vec3 d[6] = vec3[6](vec3(1, -c.y, -c.x), vec3(-1, -c.y, c.x), vec3(c.x, 1, c.y),
                        vec3(c.x, -1, -c.y), vec3(c.x, -c.y, 1), vec3(-c.x, -c.y, -1));
    imageStore(sky, at, vec4(scale * normalize(d[at.z]), 1.0));
}
"""


class Asker(Module):
    """Asks for a job when the picture's size changes; keeps the results."""

    manifest = Manifest(name="asker", title="Asker", version="1")
    job = GpuJob(
        module="asker",
        job="directions",
        compute_shader=DIRECTIONS,
        uniforms={"scale": 2.0, "not_there": 1.0},
        output="cube",
        size=SIZE,
        format="rgba32f",
        groups=(SIZE // 8, SIZE // 8, 6),
        read_back=True,
    )

    def __init__(self, link, settings):
        super().__init__(link, settings)
        self.results = []

    @handles(Resize)
    def on_resize(self, message: Resize) -> None:
        self.link.post(self.job)

    @handles(JobResult)
    def on_result(self, message: JobResult) -> None:
        self.results.append(message)


def run(gl_owner, asker_type):
    from vrut_lite.render.gl_jobs import GlJobs

    kernel = Kernel()
    kernel.add_module(GlJobs, owner=gl_owner, inject=kernel.inject)
    kernel.add_module(asker_type)
    kernel.inject(Resize(width_px=16, height_px=16))
    kernel.pump()
    wait(kernel.seats["gl_jobs"].module.pending)
    kernel.pump()
    return kernel.seats["asker"].module.results


def test_a_compute_shader_fills_a_cube_and_the_result_is_an_input(gl_owner):
    """Texel directions from the GPU are those of geometry/cube_map.py, to float32."""
    (result,) = run(gl_owner, Asker)
    assert result.error == ""
    assert result.value.shape == (6, SIZE, SIZE, 4)
    np.testing.assert_allclose(result.value.values[..., :3], 2 * texel_directions(SIZE), atol=1e-6)


def test_a_shader_that_does_not_compile_is_a_result_too(gl_owner):
    """The module must learn of it; the GL thread must go on."""

    class Broken(Asker):
        job = GpuJob(module="asker", job="x", compute_shader="#version 430\nvoid main() { y }",
                     uniforms={}, output="2d", size=8)  # fmt: skip

    (result,) = run(gl_owner, Broken)
    assert result.value is None
    assert "y" in result.error
    assert run(gl_owner, Asker)[0].error == ""


def test_a_texture_without_memory_is_a_failed_job(gl_owner):
    """Not a black sky: the module's processor then serves. Mesa refuses such a size itself."""
    if not gl_owner.opened.renderer.startswith("llvmpipe"):
        pytest.skip("a card may have room for it")

    class TooLarge(Asker):
        job = msgspec.structs.replace(Asker.job, size=16384, read_back=False)

    (result,) = run(gl_owner, TooLarge)
    assert result.value is None
    assert "no graphics memory for a texture of 16384 x 16384" in result.error
    assert run(gl_owner, Asker)[0].error == ""


class Keeper(Asker):
    job = GpuJob(module="asker", job="x", compute_shader=DIRECTIONS, uniforms={"scale": 1.0},
                 output="cube", size=SIZE, format="rgba32f", groups=(2, 2, 6))  # fmt: skip


def test_without_read_back_the_texture_stays_on_the_gpu(gl_owner):
    """Only a reference comes back: nothing is copied unless somebody asks."""
    (result,) = run(gl_owner, Keeper)
    assert result.value == GpuTexture(size=SIZE, format="rgba32f", recipe=Keeper.job.recipe)
    face = gl_owner.call(lambda _: np.frombuffer(result.value.opaque.read(4), np.float32))
    face = face.reshape(SIZE, SIZE, 4)[..., :3]
    np.testing.assert_allclose(face, texel_directions(SIZE)[4], atol=1e-6)


def test_a_held_texture_is_never_written_over(gl_owner):
    """While one is shown the next is made elsewhere; who let go gives the texels back."""
    from vrut_lite.render.texture_pool import TexturePool

    pool = TexturePool()

    def take(context):
        return pool.take(context, Keeper.job)

    shown, made = gl_owner.call(take), gl_owner.call(take)
    assert shown.opaque.glo != made.opaque.glo
    names = {shown.opaque.glo, made.opaque.glo}
    for _ in range(5):
        shown = made
        made = gl_owner.call(take)
        assert made.opaque.glo != shown.opaque.glo
        assert made.opaque.glo in names


def test_a_texture_that_is_let_go_at_any_moment_is_used_again():
    """Holders live on other threads: one that lets go while the pool looks must not lose it."""

    class Dying:
        def __init__(self):
            self.asked = 0

        def __call__(self):
            self.asked += 1
            return None if self.asked > 1 else object()

    pool, dying = texture_pool.TexturePool(), Dying()
    kind = "cube", 8, "rgba16f"
    pool._lent.append(texture_pool._Lent(kind, None, "texture", dying))
    assert pool._free_one(kind) is None
    assert pool._free_one(kind) == "texture"


def test_buffers_stay_known_where_the_next_cannot_be_made():
    """What one job had is released by its end, what a failed one has made by the next."""
    from vrut_lite.render.job_buffers import JobBuffers

    class Buffer:
        def __init__(self):
            self.released = False

        def bind_to_storage_buffer(self, _binding):
            pass

        def release(self):
            self.released = True

    class Context:
        def __init__(self):
            self.made = []

        def buffer(self, data):
            if not data:
                raise ValueError("a buffer of nothing")
            self.made.append(Buffer())
            return self.made[-1]

    def program(*contents):
        return tuple(enumerate(Array(np.array(content, np.float32)) for content in contents))

    buffers, context = JobBuffers(), Context()
    buffers.send(context, "job", [program([1.0])])
    with pytest.raises(ValueError, match="of nothing"):
        buffers.send(context, "job", [program([2.0], [])])
    buffers.send(context, "job", [program([3.0])])
    assert [buffer.released for buffer in context.made] == [True, True, False]


def test_the_recipe_tells_what_was_computed():
    """Equal jobs make equal textures; another uniform, size or shader makes another."""
    same = msgspec.structs.replace(Keeper.job, read_back=True)
    assert same.recipe == Keeper.job.recipe
    for change in ({"uniforms": {"scale": 2.0}}, {"size": 32}, {"compute_shader": "other"}):
        assert msgspec.structs.replace(Keeper.job, **change).recipe != Keeper.job.recipe


BUFFERED = """
#version 430
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) writeonly uniform image2D made;
layout(std430, binding = 1) readonly buffer Near { vec4 near[]; };
layout(std430, binding = 3) readonly buffer Far { float far[]; };
void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    imageStore(made, at, near[at.y] + far[at.x] * far.length());
}
"""


def test_a_shader_reads_buffers_by_their_bindings(gl_owner):
    """More numbers than uniforms can hold: each `Array` lies where its binding says."""
    near = np.arange(4 * SIZE, dtype=np.float32).reshape(SIZE, 4)
    far = np.linspace(0.0, 1.0, SIZE, dtype=np.float32)

    class Reader(Asker):
        job = GpuJob(module="asker", job="x", compute_shader=BUFFERED, uniforms={}, output="2d",
                     size=SIZE, format="rgba32f", groups=(2, 2, 1), read_back=True,
                     buffers=((3, Array(far)), (1, Array(near))))  # fmt: skip

    (result,) = run(gl_owner, Reader)
    assert result.error == ""
    expected = near[:, None] + far[None, :, None] * SIZE
    np.testing.assert_array_equal(result.value.values, expected)


LAYERS = """
#version 430
layout(local_size_x = 4, local_size_y = 4) in;
layout(rgba32f, binding = 0) writeonly uniform image3D made;
layout(std430, binding = 1) readonly buffer Numbers { float number[]; };
void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(at, imageSize(made)))) return;
    imageStore(made, at, vec4(at, number[at.z]));
}
"""


def test_a_shader_fills_layers(gl_owner):
    """A 3-D image of three sizes, none a multiple of the groups', read back layer by layer; or a
    texture that says its size."""
    width, height, depth = size = (5, 6, 3)
    numbers = Array(np.array([8.0, 1.5, 4.0], np.float32))

    class Layers(Asker):
        job = GpuJob(module="asker", job="x", compute_shader=LAYERS, uniforms={}, output="3d",
                     size=size, format="rgba32f", groups=(2, 2, depth), read_back=True,
                     buffers=((1, numbers),))  # fmt: skip

    class Kept(Layers):
        job = msgspec.structs.replace(Layers.job, read_back=False)

    (result,) = run(gl_owner, Layers)
    assert result.error == ""
    z, y, x = np.indices((depth, height, width))
    expected = np.stack([x, y, z, numbers.values[z]], axis=-1)
    np.testing.assert_array_equal(result.value.values, expected)
    (kept,) = run(gl_owner, Kept)
    assert kept.value == GpuTexture(size=size, format="rgba32f", recipe=Layers.job.recipe)
    # A journal keeps the plain fields, in which a tuple is a list.
    assert GpuTexture.of(to_plain(kept.value)) == kept.value


def test_a_buffer_that_is_there_is_not_sent_again(gl_owner):
    """The very array that the last job of the name had; another of the same content is sent."""
    from vrut_lite.render.gl_jobs import GlJobs

    results = []
    jobs = GlJobs(SimpleNamespace(), None, owner=gl_owner, inject=results.append)
    near = Array(np.ones((SIZE, 4), np.float32))
    for step, kept in ((1.0, None), (2.0, 1), (3.0, 2)):
        far = Array(np.full(SIZE, step, np.float32))
        job = GpuJob(module="asker", job="x", compute_shader=BUFFERED, uniforms={}, output="2d",
                     size=SIZE, format="rgba32f", groups=(2, 2, 1), read_back=True,
                     buffers=((1, near), (3, far)))  # fmt: skip
        jobs.on_job(job)
        wait(jobs.pending)
        assert np.all(results[-1].value.values == 1.0 + step * SIZE)
        assert jobs.counters.skipped.get("gpu job's buffer: still there") == kept
    near = Array(near.values.copy())
    jobs.on_job(msgspec.structs.replace(job, buffers=((1, near), (3, far))))
    wait(jobs.pending)
    assert jobs.counters.skipped["gpu job's buffer: still there"] == 3


def test_jobs_that_take_turns_keep_their_textures(gl_owner):
    """A sky's cube and its air are made one after the other: two textures each, and no more."""
    from vrut_lite.render.gl_jobs import GlJobs

    results = []
    jobs = GlJobs(SimpleNamespace(), None, owner=gl_owner, inject=results.append)
    layers = GpuJob(module="asker", job="layers", compute_shader=LAYERS, uniforms={}, output="3d",
                    size=(4, 4, 2), format="rgba32f", groups=(1, 1, 2),
                    buffers=((1, Array(np.zeros(2, np.float32))),))  # fmt: skip
    made, shown = {"x": {}, "layers": {}}, {}
    for _ in range(5):
        for job in (Keeper.job, layers):
            jobs.on_job(job)
            wait(jobs.pending)
            shown[job.job] = results.pop().value
            # The objects themselves are kept, lest a number or a name be given again.
            texture = shown[job.job].opaque
            made[job.job][id(texture)] = texture
    assert [len(textures) for textures in made.values()] == [2, 2]


def test_buffers_are_part_of_the_recipe():
    """Their content and their binding; a job without any keeps the recipe it always had."""
    assert Keeper.job.recipe == "8fddbe9e550415e9cf55904875979019"
    recipes = {
        msgspec.structs.replace(Keeper.job, buffers=buffers).recipe
        for buffers in (
            (),
            ((1, Array(np.zeros(4, np.float32))),),
            ((1, Array(np.ones(4, np.float32))),),
            ((2, Array(np.ones(4, np.float32))),),
        )
    }
    assert len(recipes) == 4


def test_a_journal_gives_a_job_back_with_its_buffers():
    """As any message with arrays."""
    job = msgspec.structs.replace(Keeper.job, buffers=((1, Array(np.ones(4, np.float32))),))
    (array,) = arrays_of(job)
    assert decode(GpuJob, to_plain(job), lambda handle: array) == job


def test_a_runner_of_jobs_demands_them(gl_owner):
    """A module asks `wanted(GpuJob)`: without a GL owner in the kernel nobody does."""
    from vrut_lite.render.gl_jobs import GlJobs

    kernel = Kernel()
    assert kernel.wanted(GpuJob) is None
    kernel.add_module(GlJobs, owner=gl_owner, inject=kernel.inject)
    kernel.pump()
    assert kernel.wanted(GpuJob) is not None


DOUBLED = """
#version 430
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform imageCube sky;
layout(rgba32f, binding = 1) readonly uniform imageCube other;
layout(rgba32f, binding = 2) uniform imageCube kept;
layout(std430, binding = 1) readonly buffer Added { float added[]; };
uniform int number;
void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    vec4 before = imageLoad(sky, at);
    if (number == 0) {
        imageStore(kept, at, 10.0 * before);
        imageStore(sky, at, vec4(0.0));
    } else {
        imageStore(sky, at, imageLoad(kept, at) + imageLoad(other, at) + added[0]);
    }
}
"""


def steps(added):
    """Two programs of one text: the first keeps ten times the image, the second adds to it."""
    return tuple(
        GpuPass(compute_shader=DOUBLED, uniforms={"number": number}, groups=(2, 2, 6),
                buffers=((1, Array(np.full(1, value, np.float32))),))
        for number, value in enumerate((0.0, added))
    )  # fmt: skip


def test_programs_of_a_job_run_one_after_the_other(gl_owner):
    """On one image, with an image that they keep, another job's texture, and buffers of their own.

    10 d + 2 d + 0.5 of each texel's direction d.
    """
    (other,) = run(gl_owner, type("Other", (Keeper,), {
        "job": msgspec.structs.replace(Keeper.job, uniforms={"scale": 2.0}),
    }))  # fmt: skip

    class Several(Asker):
        job = msgspec.structs.replace(
            Keeper.job, then=steps(0.5), scratch=1, reads=other.value, read_back=True
        )

    (result,) = run(gl_owner, Several)
    assert result.error == ""
    expected = 12.0 * texel_directions(SIZE) + 0.5
    np.testing.assert_allclose(result.value.values[..., :3], expected, atol=1e-5)


def test_further_programs_are_part_of_the_recipe_and_of_a_journal():
    """Their text, uniforms, groups and buffers, and the texture that is read."""
    texture = GpuTexture(size=SIZE, format="rgba32f", recipe="that")
    jobs = [
        msgspec.structs.replace(Keeper.job, **more)
        for more in (
            {},
            {"then": steps(0.5)},
            {"then": steps(0.6)},
            {"then": steps(0.5)[:1]},
            {"reads": texture},
            {"then": steps(0.5), "reads": texture},
        )
    ]
    assert len({job.recipe for job in jobs}) == len(jobs)
    for job in jobs:
        job.check()
        plain = to_plain(job)
        assert recipe_of_plain(plain) == job.recipe
        arrays = {array.digest: array for array in arrays_of(job)}
        assert decode(GpuJob, plain, lambda handle, of=arrays: of[handle["$array"]]) == job


def test_of_waiting_jobs_only_the_latest_is_run(gl_owner):
    """A dragged slider must not fill the GL thread with skies that nobody will see."""
    import threading

    from vrut_lite.render.gl_jobs import GlJobs

    class Dragged(Keeper):
        @handles(Resize)
        def on_resize(self, message):
            uniforms = {"scale": float(message.width_px)}
            self.link.post(msgspec.structs.replace(self.job, uniforms=uniforms))

    kernel = Kernel()
    kernel.add_module(GlJobs, owner=gl_owner, inject=kernel.inject)
    kernel.add_module(Dragged)
    hold = threading.Event()
    gl_owner.submit(lambda _: hold.wait(10))
    for width in (1, 2, 3):
        kernel.inject(Resize(width_px=width, height_px=1))
        kernel.pump()
    jobs = kernel.seats["gl_jobs"].module
    hold.set()
    wait(jobs.pending)
    kernel.pump()
    assert len(kernel.seats["asker"].module.results) == 1
    assert jobs.counters.skipped["gpu job outdated"] == 2


def test_a_job_asked_for_while_another_of_its_key_runs_is_answered(gl_owner):
    """Each answers for itself: the end of the first must not make the second's fail unheard."""
    from vrut_lite.render.gl_jobs import GlJobs

    results = []
    jobs = GlJobs(SimpleNamespace(), None, owner=gl_owner, inject=results.append)
    compute, second = jobs._compute, msgspec.structs.replace(Asker.job, size=2 * SIZE)

    def asked_meanwhile(context, job):
        found = compute(context, job)
        if job is Asker.job:
            jobs.on_job(second)
        return found

    jobs._compute = asked_meanwhile
    jobs.on_job(Asker.job)
    while jobs.pending:
        wait(waiting := list(jobs.pending))
        jobs.pending = [future for future in jobs.pending if future not in waiting]
    values = [each.value for each in results if isinstance(each, JobResult)]
    assert [value.shape[1] for value in values] == [SIZE, 2 * SIZE]
