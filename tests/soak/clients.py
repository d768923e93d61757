"""The clients of a soak: each a thread that goes on until it is told to stop."""

from __future__ import annotations

import hashlib
import os
import pathlib
import random
import signal
import subprocess
import threading
import time
from typing import Callable, List, Optional

import lipofill
from journal import Journal
from lipofill.v1 import simulation_pb2
from workload import Runners, Uploaders, Viewers

PATIENCE = lipofill.RetryPolicy(patience_s=120.0)


class Client(threading.Thread):
    """Takes a `step`, and others until the stop. What one raises is a complaint, and ends it."""

    def __init__(self, name: str, server: str, journal: Journal, stop: threading.Event, seed: int) -> None:
        super().__init__(name=name, daemon=True)
        self.journal = journal
        self.stop = stop
        self.random = random.Random(f"{seed} {name}")
        self.connection = lipofill.Connection(server, retry=PATIENCE)

    def run(self) -> None:
        try:
            self.step()
            while not self.stop.is_set():
                self.step()
            self.finish()
        except Exception as error:
            self.journal.complain(f"{self.name}: {type(error).__name__}: {error}")
        finally:
            self.connection.close()

    def step(self) -> None:
        raise NotImplementedError

    def finish(self) -> None:
        """Leaves nothing behind."""

    def wait_up_to(self, seconds: float) -> None:
        self.stop.wait(self.random.uniform(0, seconds))

    def chance(self, share: float) -> bool:
        return self.random.random() < share


def plate() -> lipofill.Plan:
    """A small plate over bone: thirty steps, a few milliseconds each."""
    plan = lipofill.Plan("plate").square(40, 40, n_xi=16, n_eta=16)
    plan.layer("skin", thickness_mm=3, youngs_modulus_kpa=60, poisson_ratio=0.45, density_kg_m3=1100)
    plan.film("deep", below="skin", n_xi=8, n_eta=8, zones={"middle": lipofill.box(0.16, 0.84, 0.16, 0.84)})
    plan.inject("middle", volume_ml=0.3, rate_ml_per_s=1.0)
    plan.simulation.time.step_ms, plan.simulation.time.end_s = 10, 1.0
    plan.simulation.time.settle_skin_speed_mm_per_s = 0
    return plan


class Runner(Client):
    """Carries out plans, steers some of them, and checks every ledger and the state of those nobody
    steered.
    """

    def __init__(self, options: Runners, folder: pathlib.Path, *arguments: object) -> None:
        super().__init__(*arguments)  # type: ignore[arg-type]
        self.options = options
        self.plan = plate() if options.plan == "plate" else lipofill.Plan.load(folder / options.plan)
        self.base: Optional[lipofill.Run] = None

    def step(self) -> None:
        if self.base is None or self.chance(self.options.rebuild_share):
            self.finish()
            self.base = self.connection.run(self.plan, keep=True)
            self.base.delete()  # the model is what is wanted
            self.journal.count("models built")
        plan = self.plan.copy()
        plan.simulation.injections[0].volume_ml = self.random.choice(self.options.volumes_ml)
        plan.simulation.model = self.base.model.name
        run = self.connection.simulations.create(plan.simulation)
        self.carry_out(run, plan)
        run.delete()
        self.wait_up_to(self.options.pause_s)

    def finish(self) -> None:
        base, self.base = self.base, None
        if base is not None:
            base.discard()

    def carry_out(self, run: lipofill.Simulation, plan: lipofill.Plan) -> None:
        run.start()
        more_ml, steered = self.steer(run, plan)
        ended = run.wait()
        self.journal.count("runs")
        self.journal.count("steps", ended.summary.steps)
        if ended.summary.steps == 0:
            return
        self.journal.check_ledger(run.name, ended, run.series(), total_ml(plan.simulation), more_ml)
        if not steered:
            self.journal.note_hash(plan_key(plan), ended.summary.state_hash)

    def steer(self, run: lipofill.Simulation, plan: lipofill.Plan) -> tuple[float, bool]:
        """What a planner does while it runs; how much was injected besides, and whether the result
        is another for it.
        """
        try:
            return self._steer(run, plan)
        except lipofill.FailedPreconditionError:
            self.journal.count("commands after the end")  # it was faster
            more_ml = total_ml(run.get().spec) - total_ml(plan.simulation)
            return more_ml, True

    def _steer(self, run: lipofill.Simulation, plan: lipofill.Plan) -> tuple[float, bool]:
        more_ml, steered = 0.0, False
        if self.chance(self.options.pause_share):
            run.pause()
            self.wait_up_to(0.1)
            run.resume()
            self.journal.count("pauses")
        if self.chance(self.options.inject_share):
            first = plan.simulation.injections[0]
            run.inject(first.zone, volume_ml=0.05, rate_ml_per_s=first.rate_ml_per_s)
            more_ml, steered = 0.05, True
            self.journal.count("injections")
        if self.chance(self.options.checkpoint_share):
            kept = run.checkpoint()
            self.journal.count("checkpoints")
            if self.chance(0.5):
                run.restore(kept.name)
                self.journal.count("restores")
        if self.chance(self.options.stop_share):
            run.stop()
            steered = True
            self.journal.count("stops")
        return more_ml, steered


def total_ml(spec: simulation_pb2.SimulationSpec) -> float:
    """What is to be injected."""
    return sum(injection.volume_ml for injection in spec.injections)


def plan_key(plan: lipofill.Plan) -> str:
    """A plan whatever its model is called: the same key, the same state."""
    nameless = plan.copy()
    nameless.simulation.model = ""
    volume_ml = plan.simulation.injections[0].volume_ml
    return f"{plan.message.name} {volume_ml:g} mL {hashlib.sha256(nameless.to_json().encode()).hexdigest()[:8]}"


class Uploader(Client):
    """Uploads sheets of triangles and deletes the oldest."""

    def __init__(self, options: Uploaders, folder: pathlib.Path, *arguments: object) -> None:
        super().__init__(*arguments)  # type: ignore[arg-type]
        self.options = options
        self.folder = folder
        self.patient = ""
        self.kept: List[str] = []

    def step(self) -> None:
        if not self.patient:
            self.patient = self.connection.patients.create().name
        cells, height = self.random.randint(*self.options.cells), self.random.random()
        file = self.folder / f"{self.name}.obj"
        file.write_text(sheet(cells, height))
        scan = self.connection.scans.upload(self.patient, file)
        if not scan.complete or scan.report.triangles != 2 * cells * cells or scan.size_bytes != file.stat().st_size:
            self.journal.complain(f"{scan.name}: {scan.report.triangles} triangles of {2 * cells * cells}")
        self.journal.count("uploads")
        self.journal.count("uploaded bytes", scan.size_bytes)
        self.kept.append(scan.name)
        while len(self.kept) > self.options.keep:
            self.connection.scans.delete(self.kept.pop(0))
        self.wait_up_to(self.options.pause_s)

    def finish(self) -> None:
        if self.patient:
            self.connection.patients.delete(self.patient, force=True)


def sheet(cells: int, height: float) -> str:
    """A square sheet as OBJ: 2 cells^2 triangles."""
    side = range(cells + 1)
    lines = [f"v {80 * i / cells:.6f} {80 * j / cells:.6f} {height * i * j / cells**2:.6f}" for j in side for i in side]
    for j in range(cells):
        for i in range(cells):
            a = j * (cells + 1) + i + 1
            lines += [f"f {a} {a + 1} {a + cells + 2}", f"f {a} {a + cells + 2} {a + cells + 1}"]
    return "\n".join(lines) + "\n"


class Viewer(Client):
    """Watches whatever runs, in its own way, and checks that frames come in order."""

    def __init__(self, options: Viewers, *arguments: object) -> None:
        super().__init__(*arguments)  # type: ignore[arg-type]
        self.options = options
        self.server = self.connection.server

    def step(self) -> None:
        name = self.present()
        if name is None:
            self.stop.wait(0.05)
            return
        try:
            if self.options.behaviour in ("killed", "frozen"):
                self.watch_process(name)
            else:
                self.watch(name)
        except lipofill.NotFoundError:
            pass  # it was deleted meanwhile
        self.journal.count(f"watches, {self.options.behaviour}")

    def present(self) -> Optional[str]:
        # Also those that are READY: of some of them not even the maker knows yet.
        states = (simulation_pb2.Simulation.READY, simulation_pb2.Simulation.RUNNING, simulation_pb2.Simulation.PAUSED)
        running = [each.name for each in self.connection.simulations.list() if each.state in states]
        return self.random.choice(running) if running else None

    def watch(self, name: str) -> None:
        last: Optional[lipofill.Frame] = None
        leave_after = self.random.randint(1, 40) if self.options.behaviour in ("leave", "stall") else None
        simulation = self.connection.simulations[name]
        with simulation.watch(delivery=self.options.delivery, heartbeat_ms=1000, patience_s=120.0) as frames:
            for number, frame in enumerate(frames, 1):
                self.check(name, last, frame)
                last = frame
                if self.options.behaviour == "slow":
                    time.sleep(0.02)
                if number == leave_after or self.stop.is_set():
                    if self.options.behaviour == "stall":
                        self.wait_up_to(3.0)
                    break

    def check(self, name: str, last: Optional[lipofill.Frame], frame: lipofill.Frame) -> None:
        self.journal.count("frames")
        self.journal.count("skipped frames", frame.skipped_frames)
        if last is None or frame.end:
            return
        step = frame.sequence - last.sequence
        in_order = step == 1 if self.options.delivery == "EVERY" else step >= 1
        if frame.epoch < last.epoch or (frame.epoch == last.epoch and not in_order):
            self.journal.complain(
                f"{name}: frame {frame.sequence} of epoch {frame.epoch} after {last.sequence} of {last.epoch}"
            )

    def watch_process(self, name: str) -> None:
        """A viewer in a process of its own, that is killed, or frozen first."""
        command = [os.environ["LIPOFILL"], "watch", name, "--server", self.server]
        command += ["--every"] if self.options.delivery == "EVERY" else []
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.wait_up_to(0.5)
        if self.options.behaviour == "frozen":
            process.send_signal(signal.SIGSTOP)
            self.wait_up_to(3.0)
        process.kill()
        process.wait()


class Reaper(threading.Thread):
    """Ends the daemon now and then, by SIGKILL or SIGTERM, and starts it again."""

    def __init__(
        self,
        daemon: lipofill.Daemon,
        end: Callable[[], object],
        what: str,
        span_s: tuple[float, float],
        lock: threading.Lock,
        journal: Journal,
        stop: threading.Event,
        seed: int,
    ) -> None:
        super().__init__(name=what, daemon=True)
        self.daemon_process, self.end, self.what, self.span_s = daemon, end, what, span_s
        self.lock, self.journal, self.stop = lock, journal, stop
        self.random = random.Random(f"{seed} {what}")

    def run(self) -> None:
        while not self.stop.wait(self.random.uniform(*self.span_s)):
            with self.lock:
                code = self.end()
                self.daemon_process.start()
            self.journal.count(self.what)
            if self.what == "restarts" and code != 0:
                self.journal.complain(f"the daemon ended with code {code} when asked to")
