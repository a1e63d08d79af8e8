"""The host on a thread of its own: it pumps, draws when something changed, answers questions.

Each round the kernel admits the inputs of one revision, and a frame of the last whole one is
drawn. Inputs that arrive meanwhile merge in the kernel's inbox; before a moving picture is done the
kernel acts on them, beside it, so early that what they cause is whole when it is. A finished
picture may take seconds; new inputs end it early.
"""

import threading
from collections.abc import Callable, Hashable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from time import perf_counter
from typing import Any, NamedTuple, Protocol, TypeVar

from vrut_lite.app.engine.adaptation import Adaptation
from vrut_lite.app.engine.finer_light import FinerLight, is_only_finer, is_only_lit
from vrut_lite.app.engine.finishing import Finishing
from vrut_lite.app.engine.module_catalogue import catalogue_of
from vrut_lite.app.engine.pacing import REST_S, Kind, Pacing, scaled
from vrut_lite.app.engine.requests import Requests
from vrut_lite.app.engine.revision_gate import DEADLINE_S, RevisionGate
from vrut_lite.app.engine.revision_news import ENDED, PICTURE, READY, RevisionNews
from vrut_lite.app.engine.stage import Stage
from vrut_lite.app.engine.window_jobs import WindowJobs
from vrut_lite.errors import GivenUp
from vrut_lite.kernel.bus import Kernel
from vrut_lite.kernel.messages import Input
from vrut_lite.messages.picture import SetExposure
from vrut_lite.pictures.picture import Picture
from vrut_lite.render.change_of_light import change_of_light
from vrut_lite.scene.scene_state import SceneState

T = TypeVar("T")
# The kernel begins a revision so many times its usual time before a picture is due: both take
# longer beside each other.
_EARLIER = 1.5


class Shown(NamedTuple):
    """A picture and what it shows.

    Attributes:
        picture: the pixels.
        still: whether it is finished.
        seconds: how long it was drawn.
        held: whether its exposure is held.
        revision: number of the kernel's revision that it shows.
        drafts: names of modules for whose part a draft serves.
        refining: names of modules that make their part finer.
        whole_in_s: median and 95th percentile of the time from a gesture to its whole state.
    """

    picture: Picture
    still: bool
    seconds: float
    held: bool = False
    revision: int = 0
    drafts: tuple[str, ...] = ()
    refining: tuple[str, ...] = ()
    whole_in_s: tuple[float, float] = (0.0, 0.0)


class Watcher(Protocol):
    """Who draws the same states elsewhere, as for a headset."""

    def show(self, state: SceneState) -> None:
        """Take a state to draw; it may lack parts, and be the one before."""

    def close(self) -> None:
        """Draw no more; the stage is closed thereafter."""


class Engine:
    """`tell(key, value)` is called on the engine's thread and must be quick.

    The context manager `attend(stage)` is entered on the engine's thread while the stage is open.
    """

    def __init__(
        self,
        open_stage: Callable[[], Stage],
        tell: Callable[[Hashable, Any], None],
        attend: Callable[[Stage], AbstractContextManager[object]] = nullcontext,
        now_s: Callable[[], float] = perf_counter,
        deadline_s: float = DEADLINE_S,
    ):
        self._open_stage = open_stage
        self._attend = attend
        self._now_s = now_s
        self._requests = Requests()
        self._news = RevisionNews(tell, now_s)
        self._pacing = Pacing()
        self._adaptation = Adaptation()
        self._finer_light = FinerLight()
        self._gate = RevisionGate(deadline_s, now_s)
        # When an input came last.
        self._sent_at_s = 0.0
        self._finishing = Finishing()
        self._watcher: Watcher | None = None
        self._drawn: SceneState | None = None
        # The last picture that was not finished.
        self._moved_from: SceneState | None = None
        # Draws a moving picture while the kernel is pumped.
        self._pictures = ThreadPoolExecutor(1, "vrut-lite picture")
        # Whether a revision has begun beside the last picture.
        self._was_beside = False
        self._thread = threading.Thread(target=self._run, name="vrut-lite engine", daemon=True)

    # --- from any thread -------------------------------------------------------------------

    def start(self) -> None:
        """Open the stage and begin."""
        self._thread.start()

    def send(self, *inputs: Input) -> None:
        """Send inputs to the kernel, also before the stage is open."""
        self._requests.send(*inputs)

    def ask(self, question: Callable[[Stage], T], changes: bool = False) -> "Future[T]":
        """Call `question` on the engine's thread, after the inputs that were sent before.

        A question that `changes` something interrupts a finished picture that is being drawn.
        """
        return self._requests.ask(question, changes)

    def meter_exposure(self) -> None:
        """Draw a new picture now and meter automatic exposure by it."""

        def meter(stage: Stage) -> None:
            self._adaptation.meter_anew()
            self._drawn = None

        self.ask(meter, changes=True)

    def watch(self, watcher: Watcher | None) -> None:
        """Show the states to somebody else too; None: to nobody.

        Meanwhile no picture is finished here: it would hold the GL thread for longer than a frame.
        """

        def begin(stage: Stage) -> None:
            self._watcher = watcher
            if watcher is not None:
                watcher.show(stage.state)

        self.ask(begin, changes=True)

    def stop(self) -> None:
        """Request the end of the thread, which then posts ENDED."""
        self._requests.end()

    def join(self, timeout_s: float | None = None) -> bool:
        """Wait for the end; False after the timeout."""
        self._thread.join(timeout_s)
        return not self._thread.is_alive()

    # --- on the engine's thread ------------------------------------------------------------

    def _run(self) -> None:
        stage = self._opened()
        try:
            if stage is not None:
                with self._attend(stage):
                    self._live(stage)
                if self._watcher is not None:
                    self._watcher.close()
                self._pictures.shutdown()
                stage.close()
        finally:
            self._requests.cancel()
            self._news.tell(ENDED, None)

    def _opened(self) -> Stage | None:
        try:
            stage = self._open_stage()
        except BaseException as error:
            self._news.problem(error)
            return None
        if stage.device is not None:
            self._pacing.expect(stage.device.choices.expected_s)
        stage.kernel.tap(self._news.hear)
        for failure in stage.failures:
            self._news.problem(failure)
        self._news.tell(READY, catalogue_of(stage))
        return stage

    def _live(self, stage: Stage) -> None:
        # After `attend`: a journal must begin before the first input.
        requests = self._requests
        requests.connect(stage.kernel)
        while not requests.ending.is_set():
            requests.awake.wait(self._patience_s(stage.kernel))
            requests.awake.clear()
            requests.moved_on.clear()
            # Counted before the pump: inputs that were sent before a question are acted on first.
            questions = requests.questions
            self._make_way(stage)
            # After a rest a hand waits for the first picture: jobs that its input starts begin
            # thereafter. In motion they run beside pictures: light would be older by one.
            with _held(stage.kernel) if self._finishing.stands else nullcontext():
                self._pump_unless_ahead(stage, questions)
                # Answers are of one revision, as pictures are.
                if stage.kernel.is_whole:
                    requests.answer(stage, questions)
                rests = not requests.ending.is_set() and not self._draw_what_moved(stage)
            if rests:
                self._settle(stage)
            if stage.kernel.waiting and stage.kernel.is_whole:
                requests.awake.set()
        stage.kernel.on_inject(None)

    def _make_way(self, stage: Stage) -> None:
        """Let what inputs cause go before the finer light of the present picture."""
        if self._requests.sent.is_set():
            self._requests.sent.clear()
            self._sent_at_s = self._now_s()
            self._finer_light.give_way(stage.kernel, stage.state, self._sent_at_s)
        self._finer_light.resume(stage.kernel, self._now_s())

    def _patience_s(self, kernel: Kernel) -> float | None:
        may_finish = self._adaptation.is_near and self._watcher is None
        finish_at_s = self._finishing.due_s if may_finish else None
        times_s: tuple[float | None, ...] = (self._gate.due_s, self._finer_light.resumes_at_s)
        if kernel.is_whole:
            times_s = (*times_s, finish_at_s, self._adaptation.wakes_at_s)
        due_s = min((time_s for time_s in times_s if time_s is not None), default=None)
        return None if due_s is None else max(0.0, due_s - self._now_s())

    def exposure_of(self, state: SceneState) -> SetExposure:
        """The exposure that a finished picture has in the window; on the engine's thread."""
        return self._adaptation.exposure_of(state)

    def _pump_unless_ahead(self, stage: Stage, questions: int) -> None:
        """Act on inputs, unless what those before did is still to be drawn and nobody asks."""
        is_ahead, self._was_beside = self._was_beside, False
        if questions:
            self._pump(stage, self._gate.pump_all)
        elif not is_ahead:
            self._pump(stage, self._gate.pump)
        elif stage.kernel.waiting:
            self._requests.awake.set()

    def _pump(self, stage: Stage, pump: Callable[[Kernel], None]) -> None:
        kernel = stage.kernel
        while True:
            try:
                pump(kernel)
            # An error in the host itself: the message that raised it is lost, the others go on.
            except BaseException as error:
                self._news.problem(error)
            else:
                break
        self._news.waits_for(kernel.jobs.modules("awaited"))
        if kernel.is_whole:
            self._news.publish()
        self._news.camera_is(stage.state.camera)
        if self._watcher is not None:
            self._watcher.show(stage.state)

    def _draw_what_moved(self, stage: Stage) -> bool:
        """Draw a state that was not drawn yet; False if it was, or cannot be finished yet."""
        if stage.state.missing:
            return False
        # Light that comes late refines a finished picture, without a coarse one between.
        if is_only_finer(self._drawn, stage.state) or (
            self._finishing.stands and is_only_lit(self._drawn, stage.state)
        ):
            self._drawn = stage.state
            self._finishing.lit(self._now_s())
        if stage.state is self._drawn:
            return False
        self._drawn = stage.state
        self._draw_one(stage, self._kind_of(stage))
        self._finishing.moved(self._sent_at_s + REST_S)
        return True

    def _settle(self, stage: Stage) -> None:
        """Draw the finished picture, or one more exposure, if it is due while nothing moves."""
        # A question may have injected inputs, as an undo does: they are pumped first.
        if self._requests.awake.is_set() or stage.state.missing or not stage.kernel.is_whole:
            return
        now_s, adaptation, finishing = self._now_s(), self._adaptation, self._finishing
        if finishing.is_due(now_s) and adaptation.is_near and self._watcher is None:
            if stage.kernel.jobs.modules("drafted") and finishing.waits_for_drafts(now_s):
                return
            finishing.begun()
            self._draw_one(stage, "still")
        elif adaptation.wakes_at_s is not None and now_s >= adaptation.wakes_at_s:
            self._draw_one(stage, "still" if finishing.stands else self._kind_of(stage))

    def _kind_of(self, stage: Stage) -> Kind:
        """Kind of the next moving picture."""
        before = self._moved_from
        takes_over = stage.device is not None and stage.device.choices.takes_over
        if before is None or not takes_over or change_of_light(before, stage.state) is None:
            return "anew"
        same_light = before.key_light is stage.state.key_light
        return "taken over" if same_light else "taken over, relit"

    def _draw_one(self, stage: Stage, kind: Kind) -> None:
        still = kind == "still"
        scale = 1.0 if still else self._pacing.quick_scale(kind)
        start_s = self._now_s()
        adaptation, state, jobs = self._adaptation, stage.state, stage.kernel.jobs
        revision = stage.revision
        drafts, refining = jobs.modules("drafted"), jobs.modules("refines")
        for message, heard_s in self._news.take_published():
            adaptation.hear(message, heard_s)
        # The exposure of a finished picture that is not settled adapts further as it stands.
        settled = still and adaptation.settled
        exposure = (
            adaptation.exposure_of(state) if settled else adaptation.next_exposure(state, start_s)
        )
        size = scaled(state.size_px, scale)
        drawn = replace(state, size_px=size, exposure=exposure)
        requests = self._requests
        ends = requests.ending if self._finishing.insists else requests.moved_on
        try:
            if still:
                picture, end_s = stage.draw(drawn, still, ends.is_set), self._now_s()
            else:
                expected_s = self._pacing.expected_s(scale, kind)
                picture, end_s = self._draw_and_pump(stage, drawn, expected_s)
        except GivenUp:
            self._finishing.given_up(start_s)
            return
        except BaseException as error:
            self._news.problem(error)
            return
        seconds = end_s - start_s
        adaptation.drew(picture, exposure, end_s, still)
        self._pacing.drew(scale, seconds, kind)
        if not still:
            self._moved_from = state
        elif adaptation.settled and not settled:
            self._finishing.exposed(self._now_s())
        self._finishing.shown(still)
        self._finer_light.drew(stage.kernel, still)
        whole_in_s = self._gate.percentile_s(50.0), self._gate.percentile_s(95.0)
        held = adaptation.held
        shown = Shown(picture, still, seconds, held, revision, drafts, refining, whole_in_s)
        self._news.tell(PICTURE, shown)

    def _draw_and_pump(
        self, stage: Stage, drawn: SceneState, expected_s: float
    ) -> tuple[Picture, float]:
        """A moving picture and when it was done; the kernel acts beside it on what came until late.

        One revision begins beside it, which the next picture shows and need not wait for.
        """
        kernel, gate = stage.kernel, self._gate
        drawing = self._pictures.submit(lambda: (stage.draw(drawn, False), self._now_s()))
        drawing.add_done_callback(lambda _: self._requests.awake.set())
        wait((drawing,), max(0.0, expected_s - _EARLIER * gate.usual_s))
        while not (drawing.done() or kernel.waiting):
            self._requests.awake.wait()
            self._requests.awake.clear()
        if not drawing.done():
            self._make_way(stage)
            self._pump(stage, gate.pump)
            self._was_beside = True
        # Results of its jobs may start others.
        while not (drawing.done() or kernel.is_whole):
            self._requests.awake.wait()
            self._requests.awake.clear()
            self._pump(stage, lambda kernel: gate.pump(kernel, may_begin=False))
        # The wake-up that was cleared may have been for a question.
        self._requests.awake.set()
        return drawing.result()


def _held(kernel: Kernel) -> AbstractContextManager[None]:
    runner = kernel.runner
    return runner.held() if isinstance(runner, WindowJobs) else nullcontext()
