"""Forecasts of a plan, and retention."""

import pytest

import lipofill
from conftest import make_plate
from lipofill.v1 import forecast_service_pb2 as pb


@pytest.fixture(scope="module")
def case(connection):
    with connection.run(make_plate()) as run:
        plan = run.get().spec
        yield plan, "/".join(plan.model.split("/")[:2])


def test_a_forecast_tells_of_months(connection, case):
    plan, patient = case
    stages = []
    spec = pb.ForecastSpec(plan=plan, members=50, months=[3.0, 12.0])
    forecast = connection.forecasts.make(patient, spec, progress=lambda progress: stages.append(progress))
    assert [time.month for time in forecast.times] == [0.0, 3.0, 12.0]
    lifts = [next(f.p50 for f in time.figures if f.name == "max_lift") for time in forecast.times]
    assert lifts == sorted(lifts, reverse=True)
    assert forecast.causes and stages


def test_inputs_are_shown_with_their_sources(connection, case):
    plan, patient = case
    inputs = connection.forecasts.inputs(patient, pb.ForecastSpec(plan=plan))
    assert all(item.source for item in inputs)
    assert any(item.assumed for item in inputs) and not all(item.assumed for item in inputs)


def test_a_follow_up_sharpens_retention(connection):
    prior = connection.forecasts.retention(months=[12.0])
    follow_up = pb.FollowUp(month=3.0, kept_ml=6.0, standard_error_ml=0.4)
    found = connection.forecasts.retention(months=[12.0], injected_ml=10.0, follow_up=follow_up, wanted_ml=4.0)
    assert found.months[0].p95 - found.months[0].p05 < 0.5 * (prior.months[0].p95 - prior.months[0].p05)
    assert found.inject_low_ml < found.inject_ml < found.inject_high_ml


def test_what_is_wrong_is_named(connection, case):
    plan, patient = case
    with pytest.raises(lipofill.InvalidArgumentError, match="members"):
        connection.forecasts.make(patient, pb.ForecastSpec(plan=plan, members=1))
    with pytest.raises(lipofill.InvalidArgumentError, match="no more is left than was injected"):
        rising = pb.Retention(points=[pb.RetentionPoint(month=3.0, share=1.5)])
        connection.forecasts.retention(rising)
