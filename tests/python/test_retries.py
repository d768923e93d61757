"""Which requests may be made twice: decided for every method of the service, by name."""

import pytest

import lipofill
from lipofill.errors import LipofillError, UnavailableError
from lipofill.retries import Attempts, is_safe_to_repeat, with_request_id
from lipofill.v1 import (
    forecast_service_pb2,
    frame_service_pb2,
    operation_service_pb2,
    patient_service_pb2,
    plan_service_pb2,
    planning_service_pb2,
    simulation_service_pb2,
)

FILES = (
    forecast_service_pb2,
    frame_service_pb2,
    operation_service_pb2,
    patient_service_pb2,
    plan_service_pb2,
    planning_service_pb2,
    simulation_service_pb2,
)
# Streams have their own way to go on; a replacement made twice could undo another's between.
STREAMS = {"UploadScan", "Watch", "DownloadModelMesh", "DownloadScanMesh", "ExportTissueDeck", "FindShape"}
NOT_REPEATED = {*STREAMS, "UpdatePatient", "UpdatePlan"}


def methods():
    for file in FILES:
        for service in file.DESCRIPTOR.services_by_name.values():
            for method in service.methods:
                yield pytest.param(method, id=method.full_name)


@pytest.mark.parametrize("method", methods())
def test_every_method_is_repeated_or_named_as_one_that_is_not(method):
    request = method.input_type._concrete_class()
    assert is_safe_to_repeat(request) == (method.name not in NOT_REPEATED)


def test_creates_and_commands_get_a_request_id_of_their_own():
    request = simulation_service_pb2.InjectRequest(name="simulations/a")
    first, second = with_request_id(request), with_request_id(request)
    assert first.request_id and first.request_id != second.request_id and request.request_id == ""
    assert with_request_id(first) is first
    read = simulation_service_pb2.GetSimulationRequest(name="simulations/a")
    assert with_request_id(read) is read


def fast(is_safe):
    return Attempts(lipofill.RetryPolicy(patience_s=0.2, first_delay_s=0.01), is_safe)


def test_only_what_is_safe_is_repeated_unanswered():
    assert fast(True).wait_after(UnavailableError("away"))
    assert not fast(False).wait_after(UnavailableError("away"))


def test_an_answer_is_not_asked_for_again_unless_it_says_when():
    assert not fast(True).wait_after(UnavailableError("ending", from_daemon=True))
    assert fast(False).wait_after(LipofillError("full", retry_delay_s=0.01, from_daemon=True))


def test_patience_ends():
    attempts = fast(True)
    while attempts.wait_after(UnavailableError("away")):
        assert attempts.made < 50
    assert attempts.made >= 3
    assert not fast(True).wait_after(LipofillError("full", retry_delay_s=60.0, from_daemon=True))
