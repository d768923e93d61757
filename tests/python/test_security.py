"""A daemon with TLS that asks who calls: tokens, client certificates, and what is refused."""

import subprocess

import pytest

import lipofill
from conftest import SOURCE

HURRIED = lipofill.RetryPolicy(patience_s=0)


@pytest.fixture(scope="module")
def secrets(tmp_path_factory):
    """An authority, the daemon's certificate, and tokens of a planner and a viewer, by openssl."""
    folder = tmp_path_factory.mktemp("secrets")
    for arguments in ([], ["token", "dr-grey", "ward", "planner"], ["token", "screen", "ward", "viewer"]):
        subprocess.run([SOURCE / "deploy" / "make_certificates", folder, *arguments], check=True, capture_output=True)
    return folder


@pytest.fixture(scope="module")
def server(secrets, tmp_path_factory):
    """The address of the daemon over TCP."""
    port_file = tmp_path_factory.mktemp("daemon") / "port"
    arguments = ["--listen", "127.0.0.1:0", "--port-file", port_file]
    arguments += ["--tls-certificate-file", secrets / "server.pem", "--tls-key-file", secrets / "server.key"]
    arguments += ["--token-keys-file", secrets / "token-keys.pem"]
    arguments += ["--token-issuer", "lipofill-test", "--token-audience", "lipofill"]
    with lipofill.Daemon(arguments=list(map(str, arguments))):
        yield f"localhost:{port_file.read_text().strip()}"


def connect(server, secrets, who, **more):
    files = {"ca_file": str(secrets / "ca.pem"), "token_file": str(secrets / f"token-{who}"), **more}
    return lipofill.Connection(server, credentials=lipofill.Credentials(**files), retry=HURRIED)


def test_a_planner_runs_a_plan_over_tls(server, secrets, plate):
    with connect(server, secrets, "dr-grey") as connection, connection.run(plate) as run:
        with run.watch(acknowledge=2) as frames:
            assert list(frames)[-1].end
        assert run.wait().summary.steps == 30
    with connect(server, secrets, "dr-grey") as connection:
        assert run.patient in [patient.name for patient in connection.patients.list()], "only an admin deletes patients"
        assert not list(connection.models.list(run.patient)) and not list(connection.simulations.list())


def test_a_viewer_may_not_plan(server, secrets):
    with connect(server, secrets, "screen") as connection:
        list(connection.patients.list())
        with pytest.raises(lipofill.PermissionDeniedError) as caught:
            connection.patients.create()
        assert caught.value.from_daemon


def test_who_does_not_say_who_they_are_is_refused(server, secrets):
    with connect(server, secrets, "dr-grey", token_file=None) as connection:
        with pytest.raises(lipofill.UnauthenticatedError):
            list(connection.patients.list())
        with pytest.raises(lipofill.UnauthenticatedError):
            next(connection.simulations["a"].watch())


def test_a_daemon_of_another_authority_is_not_trusted(server, secrets, tmp_path):
    subprocess.run([SOURCE / "deploy" / "make_certificates", tmp_path], check=True, capture_output=True)
    with connect(server, secrets, "dr-grey", ca_file=str(tmp_path / "ca.pem")) as connection:
        with pytest.raises(lipofill.UnavailableError):
            list(connection.patients.list())


def test_the_environment_says_who_calls(server, secrets, monkeypatch):
    monkeypatch.setenv("LIPOFILL_SERVER", server)
    monkeypatch.setenv("LIPOFILL_TLS_CA", str(secrets / "ca.pem"))
    monkeypatch.setenv("LIPOFILL_TOKEN_FILE", str(secrets / "token-screen"))
    with lipofill.Connection(retry=HURRIED) as connection:
        assert list(connection.simulations.list()) == []
