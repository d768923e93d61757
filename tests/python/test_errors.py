"""Errors: the violations and the ErrorInfo, of the daemon and of its absence."""

import pickle
import time
from concurrent import futures

import grpc
import pytest

import lipofill
from lipofill.errors import error_from_status
from lipofill.google_rpc import status_pb2


def test_every_field_out_of_bounds_is_a_violation(connection, plate):
    plate.model.layers[0].poisson_ratio = 0.7
    plate.model.n_xi = 1
    patient = connection.patients.create().name
    with pytest.raises(lipofill.InvalidArgumentError) as caught:
        connection.models.build(patient, plate.model)
    error = caught.value
    assert error.code is grpc.StatusCode.INVALID_ARGUMENT and error.reason == "FIELD_VIOLATION"
    assert {violation.field for violation in error.violations} >= {"spec.layers[0].poisson_ratio"}
    assert "0.7" in str(error) and "0.5" in str(error)
    connection.patients.delete(patient, force=True)


def test_a_wrong_simulation_names_its_fields(connection, plate):
    plate.simulation.injections[0].zone = "nowhere"
    with pytest.raises(lipofill.InvalidArgumentError) as caught:
        connection.run(plate)
    assert any("injections[0].zone" in violation.field for violation in caught.value.violations)


def test_what_is_not_there(connection):
    with pytest.raises(lipofill.NotFoundError, match="simulations/none") as caught:
        connection.simulations["none"].get()
    assert caught.value.from_daemon and caught.value.reason == "NOT_FOUND"
    with pytest.raises(lipofill.NotFoundError):
        next(connection.simulations["none"].watch())
    with pytest.raises(lipofill.NotFoundError):
        connection.patients.delete("patients/none")


def test_an_id_that_is_taken(connection):
    connection.patients.create("taken")
    with pytest.raises(lipofill.AlreadyExistsError):
        connection.patients.create("taken")
    connection.patients.delete("patients/taken")


def test_no_daemon_says_where_and_what_to_do():
    policy = lipofill.RetryPolicy(patience_s=0.3)
    started = time.monotonic()
    with lipofill.Connection("unix:/nonexistent/socket", retry=policy) as nowhere:
        with pytest.raises(lipofill.UnavailableError, match="no daemon answers at unix:/nonexistent/socket") as caught:
            nowhere.patients.get("patients/a")
        assert not caught.value.from_daemon
        with pytest.raises(lipofill.UnavailableError):
            next(nowhere.simulations["a"].watch())
    assert time.monotonic() - started > 0.3


def test_errors_can_be_caught_by_their_python_kind():
    assert issubclass(lipofill.InvalidArgumentError, ValueError)
    assert issubclass(lipofill.UnavailableError, ConnectionError)
    assert issubclass(lipofill.DeadlineExceededError, TimeoutError)


def test_a_status_without_details_is_an_error_of_its_class():
    error = error_from_status(status_pb2.Status(code=8, message="full"))
    assert isinstance(error, lipofill.ResourceExhaustedError) and not error.from_daemon and error.violations == ()
    assert error_from_status(status_pb2.Status(code=77, message="?")).code is grpc.StatusCode.UNKNOWN


def test_an_error_survives_another_process():
    error = lipofill.InvalidArgumentError("no", violations=[lipofill.FieldViolation("a", "b")], reason="R")
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error) and again.reason == "R"


def test_a_call_that_the_daemon_could_not_end_counts_as_not_answered():
    def answer(_, context):
        context.abort(grpc.StatusCode.CANCELLED, "")

    handler = grpc.method_handlers_generic_handler(
        "lipofill.v1.PatientService", {"GetPatient": grpc.unary_unary_rpc_method_handler(answer)}
    )
    server = grpc.server(futures.ThreadPoolExecutor(1))
    server.add_generic_rpc_handlers((handler,))
    port = server.add_insecure_port("127.0.0.1:0")
    server.start()
    with lipofill.Connection(f"127.0.0.1:{port}", retry=lipofill.RetryPolicy(patience_s=0)) as connection:
        with pytest.raises(lipofill.UnavailableError, match="ended before it answered"):
            connection.patients.get("patients/a")
    server.stop(None)
