"""What a Dask cluster makes is what one process makes, whatever befalls its workers."""

import os
import resource
import signal
import sys
import tempfile
import threading
import time
from pathlib import Path

import pytest
from processes_here import processes_or_skip

from vrut_lite import cli
from vrut_lite.errors import UserError
from vrut_lite.studio import dask_workers

dask = pytest.importorskip("dask", reason="distributed is not installed: extra dask")
distributed = pytest.importorskip("distributed", reason="distributed is not installed: extra dask")
ROOT = Path(__file__).parents[1]
SKIES = ("sky", "--sky", "dynamic_skylight", "--size", "16", "--at", "2026-06-21T12:00", "--from",
         "05:00", "--to", "19:00", "--step", "30m")  # fmt: skip
PICTURES = 29


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A cluster of three processes and a client of it."""
    processes_or_skip()
    folder = tmp_path_factory.mktemp("cluster")
    with (
        # After so long `restored` may replace a worker that was taken out.
        dask.config.set({"distributed.deploy.lost-worker-timeout": "0.1s"}),
        distributed.LocalCluster(
            n_workers=3,
            threads_per_worker=1,
            dashboard_address=None,
            local_directory=folder,
            silence_logs=50,
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        yield client


def restored(cluster):
    """Wait until the cluster has three sound workers; their processes by name."""
    names = cluster.run(fill_disk, None)
    cluster.run(slow_disk, 0.0)
    if len(names) < 3:
        time.sleep(1.0)
        cluster.cluster.scale(3)
    cluster.wait_for_workers(3, timeout=120)
    return cluster.run(os.getpid)


def run(*arguments):
    """Run the command line in this process."""
    before = sys.argv
    sys.argv = ["vrut-lite", *map(str, arguments)]
    try:
        cli.main()
    finally:
        sys.argv = before


def contents(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def fill_disk(most_bytes):
    """Let no file of this process become longer, or any again."""
    hard = resource.getrlimit(resource.RLIMIT_FSIZE)[1]
    soft = hard if most_bytes is None else most_bytes
    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def slow_disk(seconds):
    """Let each temporary folder of this process take so long."""
    make = getattr(tempfile, "quick_mkdtemp", tempfile.mkdtemp)
    tempfile.quick_mkdtemp = make

    def mkdtemp(*arguments, **named):
        time.sleep(seconds)
        return make(*arguments, **named)

    tempfile.mkdtemp = mkdtemp


@pytest.fixture
def bad_workers(cluster):
    """One slow worker, one with a full disk, and the process of the third."""
    pids = restored(cluster)
    slow, full, killed = pids
    cluster.run(slow_disk, 0.3, workers=[slow])
    cluster.run(fill_disk, 100, workers=[full])
    return pids[killed]


def kill_after_first(folder, pid, killed):
    """Kill a process when the first of many files is in a folder."""
    while not killed.is_set():
        count = len(list(folder.glob("*")))
        if count:
            os.kill(pid, signal.SIGKILL)
            killed.count = count
            killed.set()
        time.sleep(0.01)


def erred(dask_scheduler):
    """How many tasks have failed."""
    return sum(entry[2] == "erred" for entry in dask_scheduler.transition_log)


def made_by(cluster, folder, pid, command):
    """Files that a command makes while a worker is killed, and how often work failed."""
    folder.mkdir()
    killed = threading.Event()
    watch = threading.Thread(target=kill_after_first, args=(folder, pid, killed))
    failed = cluster.run_on_scheduler(erred)
    watch.start()
    try:
        run(*command, "--dask", cluster.scheduler.address)
    finally:
        late = not killed.is_set()
        killed.set()
        watch.join()
    assert not late, "no worker was killed meanwhile"
    return contents(folder), cluster.run_on_scheduler(erred) - failed


def written_and_read(number):
    """A number by way of a file, as a picture of a worker comes about."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "number")
        path.write_text(f"{number}" * 1000, encoding="utf-8")
        time.sleep(0.02)
        return path.read_text(encoding="utf-8")


def test_work_is_done_in_order_though_workers_fail(cluster, bad_workers):
    """One is killed, one slow, one has a full disk: no result is missing, and none is another's."""
    failed = cluster.run_on_scheduler(erred)
    results = dask_workers.ClusterExecutor(cluster).map(written_and_read, range(60))
    found = [next(results)]
    os.kill(bad_workers, signal.SIGKILL)
    found += results
    assert found == [written_and_read(number) for number in range(60)]
    assert cluster.run_on_scheduler(erred) > failed, "the full disk was never met"


@pytest.mark.long
def test_a_sequence_is_whole_though_workers_fail(cluster, bad_workers, tmp_path):
    """The files of many skies are those of one process."""
    (tmp_path / "here").mkdir()
    run(*SKIES, "-o", tmp_path / "here" / "sky_%02d.npz")
    command = (*SKIES, "-o", tmp_path / "there" / "sky_%02d.npz")
    made, failures = made_by(cluster, tmp_path / "there", bad_workers, command)
    assert failures > 0, "the full disk was never met"
    assert len(made) == PICTURES
    assert made == contents(tmp_path / "here")


def test_full_disks_everywhere_end_in_one_sentence(cluster):
    """It names a worker and the remedy; nothing is left waiting."""
    restored(cluster)
    cluster.run(fill_disk, 100)
    executor = dask_workers.ClusterExecutor(cluster)
    try:
        asked = executor.submit(written_and_read, 1)
        with pytest.raises(UserError, match=r"\(file too large on tcp://.*\): free some.* TMPDIR"):
            asked.result(timeout=60)
    finally:
        cluster.run(fill_disk, None)


def test_workers_of_another_version_are_refused(cluster):
    """Their pictures would be others."""
    restored(cluster)

    def become(version):
        dask_workers.__version__ = version

    cluster.run(become, "0.0.1")
    try:
        asked = dask_workers.ClusterExecutor(cluster).submit(abs, -1)
        with pytest.raises(UserError, match=r"has vrut_lite 0\.0\.1, and this is .*: install one"):
            asked.result(timeout=60)
    finally:
        cluster.run(become, dask_workers.__version__)


def test_a_function_that_raises_is_called_once(cluster):
    """Only a full disk sends work elsewhere: other failures are the work's own."""
    restored(cluster)
    failed = cluster.run_on_scheduler(erred)
    asked = dask_workers.ClusterExecutor(cluster).submit(int, "no number")
    with pytest.raises(ValueError, match="no number"):
        asked.result(timeout=60)
    assert cluster.run_on_scheduler(erred) == failed + 1


@pytest.mark.long
@pytest.mark.gl
def test_frames_of_a_scene_are_whole_though_workers_fail(cluster, bad_workers, tmp_path):
    """The same with OpenGL on each worker."""
    command = ("render", ROOT / "scenes" / "sundial.glb", "--size", "48x32", "--from", "05:00",
               "--to", "19:00", "--step", "1h")  # fmt: skip
    (tmp_path / "here").mkdir()
    run(*command, "-o", tmp_path / "here" / "day_%02d.png")
    there = tmp_path / "there"
    made, failures = made_by(cluster, there, bad_workers, (*command, "-o", there / "day_%02d.png"))
    assert failures > 0, "the full disk was never met"
    assert made == contents(tmp_path / "here")


@pytest.mark.long
def test_years_of_scenes_are_whole_though_workers_fail(cluster, bad_workers, tmp_path):
    """Tables, plans, heat maps and pages of three scenes' years are those of one process."""
    scenes = []
    for number in range(3):
        scene = tmp_path / f"court_{number}.obj"
        wide = 3 + number
        scene.write_text(
            f"v 0 0 0\nv {wide} 0 0\nv {wide} 0 4\nv 0 0 4\nv 0 3 0\nv {wide} 3 0\n"
            "f 4 3 2 1\nf 1 2 6 5\n",
            encoding="utf-8",
        )
        scenes.append(scene)
    sensors = tmp_path / "desks.csv"
    sensors.write_text("1,0.8,1\n2,0.8,2\n", encoding="utf-8")
    command = ("daylight", *scenes, "--year", "--sensors", sensors, "--tolerance", "20%",
               "--sky", "dynamic_skylight", "--at", "2026-03-21T12:00")  # fmt: skip
    run(*command, "-o", tmp_path / "here")
    there = tmp_path / "there"
    made, failures = made_by(cluster, there, bad_workers, (*command, "-o", there))
    assert failures > 0, "the full disk was never met"
    assert len(made) >= 3 * 3
    assert made == contents(tmp_path / "here")
