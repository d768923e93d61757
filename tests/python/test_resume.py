"""The daemon is killed (SIGKILL) and started again: streams, uploads, calls and results go on as if
nothing had happened.
"""

import signal
import threading
import time

import numpy as np
import pytest

import lipofill
from conftest import make_plate
from lipofill.v1 import simulation_pb2
from lipofill.v1 import simulation_service_pb2 as pb

PATIENT = lipofill.RetryPolicy(patience_s=30)


@pytest.fixture
def mortal():
    """A daemon for one test, with its state kept often."""
    with lipofill.Daemon(
        arguments=["--workers", "2", "--checkpoint-interval-s", "0.05", "--drain-delay-s", "1"]
    ) as running:
        yield running


@pytest.fixture
def patient_connection(mortal):
    with lipofill.Connection(mortal.server, retry=PATIENT) as connection:
        yield connection


def restart(daemon):
    daemon.kill()
    daemon.start()


def test_a_watch_goes_on_after_the_daemon_was_killed(mortal, patient_connection):
    plan = make_plate(end_s=2)
    plan.simulation.pace = simulation_pb2.REAL_TIME
    with patient_connection.run(plan) as unbroken:
        expected = unbroken.wait().summary
    breaks, seen, run = [], [], patient_connection.run(plan)
    with run.watch(delivery="EVERY", meshes=["skin"], on_reconnect=breaks.append) as frames, run:
        for frame in frames:
            seen.append((frame.epoch, frame.sequence))
            if len(seen) in (50, 110):
                restart(mortal)
        result = run.wait().summary
    assert breaks, "the stream did not break"
    assert result.state_hash == expected.state_hash and result.steps == expected.steps
    epochs = [epoch for epoch, _ in seen]
    assert epochs == sorted(epochs) and len(set(epochs)) == 3
    for epoch in set(epochs):
        steps = [sequence for each, sequence in seen[:-1] if each == epoch]
        assert (np.diff(steps) == 1).all(), "within an epoch no frame is left out and none comes twice"
    assert seen[-1][1] == expected.steps


def test_calls_wait_for_the_daemon_and_are_carried_out_once(mortal, patient_connection):
    with patient_connection.run(make_plate(end_s=1000)) as run:
        run.pause()
        mortal.kill()
        threading.Timer(0.5, mortal.start).start()
        now = run.inject("middle", volume_ml=0.01, rate_ml_per_s=1.0)
        assert len(now.spec.injections) == 2
        request = pb.InjectRequest(name=run.name, request_id="once", injection=now.spec.injections[1])
        for _ in range(2):
            now = patient_connection.call(patient_connection.simulation_stub.Inject, request)
        assert len(now.spec.injections) == 3


def test_a_deletion_that_was_carried_out_unanswered_is_done(mortal, patient_connection):
    name = patient_connection.patients.create().name
    mortal.kill()
    threading.Timer(0.5, mortal.start).start()
    patient_connection.patients.delete(name)
    with pytest.raises(lipofill.NotFoundError):
        patient_connection.patients.delete(name)


def test_a_draining_daemon_is_asked_again_when_it_says(mortal, patient_connection):
    with lipofill.Connection(mortal.server, retry=lipofill.RetryPolicy(patience_s=0)) as impatient:
        mortal.signal(signal.SIGTERM)
        refused = None
        while refused is None:
            try:
                impatient.patients.create()
            except lipofill.UnavailableError as error:
                refused = error
    assert refused.reason == "DRAINING" and refused.from_daemon and refused.retry_delay_s > 0

    def start_again():
        while mortal.is_running():
            time.sleep(0.05)
        mortal.start()

    starter = threading.Thread(target=start_again)
    starter.start()
    assert patient_connection.patients.create().name.startswith("patients/")
    starter.join()


def write_sheet(path, cells):
    """A square sheet of triangles as OBJ, some MiB."""
    rows = np.stack(np.meshgrid(np.linspace(0, 80, cells + 1), np.linspace(0, 80, cells + 1)), -1).reshape(-1, 2)
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel() + 1
    with open(path, "w") as stream:
        stream.writelines(f"v {x:.9f} {y:.9f} {0.001 * x * y:.9f}\n" for x, y in rows)
        stream.writelines(f"f {a} {a + 1} {a + cells + 2}\nf {a} {a + cells + 2} {a + cells + 1}\n" for a in first)


def test_an_upload_goes_on_where_it_broke(tmp_path, mortal, patient_connection):
    write_sheet(tmp_path / "sheet.obj", 250)
    size = (tmp_path / "sheet.obj").stat().st_size
    assert size > 4 << 20
    patient = patient_connection.patients.create().name
    sent, killed = [], []

    def kill_once(progress):
        sent.append(progress.fraction)
        if len(sent) == 3:
            killed.append(True)
            restart(mortal)

    scan = patient_connection.scans.upload(patient, tmp_path / "sheet.obj", progress=kill_once)
    assert killed and scan.complete and scan.received_bytes == size
    assert scan.report.triangles == 2 * 250 * 250
    again = patient_connection.scans.upload(patient, tmp_path / "sheet.obj", progress=sent.append)
    assert again.name == scan.name, "the same bytes are not sent twice"


def test_an_upload_begins_where_an_earlier_one_ended(tmp_path, mortal, patient_connection):
    write_sheet(tmp_path / "sheet.obj", 250)
    patient = patient_connection.patients.create().name

    def leave(progress):
        if progress.fraction > 0.6:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        patient_connection.scans.upload(patient, tmp_path / "sheet.obj", progress=leave)
    (begun,) = patient_connection.scans.list(patient)
    first = []
    scan = patient_connection.scans.upload(patient, tmp_path / "sheet.obj", progress=first.append)
    assert scan.name == begun.name and scan.complete
    size = scan.size_bytes
    assert first[0].fraction == pytest.approx(min(begun.received_bytes + (1 << 20), size) / size)


def test_an_upload_of_which_only_the_end_is_missing_is_completed(tmp_path, mortal, patient_connection):
    write_sheet(tmp_path / "sheet.obj", 250)
    size = (tmp_path / "sheet.obj").stat().st_size
    patient = patient_connection.patients.create().name
    announced = patient_connection.scans.announce(patient, tmp_path / "sheet.obj")

    def kill_when_all_is_there():
        # What was received is then read as a surface, which takes a while: the daemon does not come
        # to its end.
        while patient_connection.scans.get(announced.name).received_bytes < size:
            pass
        restart(mortal)

    killer = threading.Thread(target=kill_when_all_is_there)
    killer.start()
    scan = patient_connection.scans.upload(patient, tmp_path / "sheet.obj")
    killer.join()
    assert scan.name == announced.name and scan.complete and scan.report.triangles == 2 * 250 * 250


def test_a_model_is_built_across_a_restart(mortal, patient_connection):
    patient = patient_connection.patients.create().name
    spec = make_plate().model
    spec.n_xi = spec.n_eta = 60
    spec.layers[0].elements_through = 1
    killed = []

    def kill_once(progress):
        if not killed:
            killed.append(progress.stage)
            restart(mortal)

    model = patient_connection.models.build(patient, spec, progress=kill_once)
    assert killed and model.report.hexahedra == 3600
    assert [each.name for each in patient_connection.models.list(patient)] == [model.name]
