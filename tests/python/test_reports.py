"""Reports of a plan, as the command line makes them."""

import json

import pytest

import lipofill
from conftest import make_plate
from lipofill.v1 import forecast_service_pb2


@pytest.fixture(scope="module")
def record(connection, tmp_path_factory):
    out = tmp_path_factory.mktemp("report")
    forecast = forecast_service_pb2.ForecastSpec(members=50, months=[12.0])
    return out, connection.reports.make(
        make_plate(), out, forecast=forecast, pseudonym="case-7", date="2026-11-30", pdf=False
    )


def test_a_report_is_a_page_and_its_figures(record):
    out, figures = record
    assert {file.name for file in out.iterdir()} >= {"report.html", "report.csv", "report.json"}
    assert json.loads((out / "report.json").read_text()) == figures
    assert "case-7" in (out / "report.html").read_text()
    assert figures["forecast"]["members"] == 50


def test_figures_are_those_that_the_daemon_gives_others(connection, record):
    _, figures = record
    with connection.run(make_plate()) as run:
        plan = run.get().spec
        patient = "/".join(plan.model.split("/")[:2])
        spec = forecast_service_pb2.ForecastSpec(plan=plan, members=50, months=[12.0], figures_only=True)
        forecast = connection.forecasts.make(patient, spec)
    told = figures["forecast"]["times"][0]["figures"][0]
    assert told["name"] == forecast.times[0].figures[0].name
    assert told["p95"] == forecast.times[0].figures[0].p95


def test_the_record_alone_leaves_nothing_behind(connection):
    before = [patient.name for patient in connection.patients.list()]
    figures = connection.reports.data(make_plate(), without_forecast=True)
    assert figures["planned"] and figures["forecast"] is None
    assert [patient.name for patient in connection.patients.list()] == before


def test_what_is_wrong_is_named(connection, tmp_path):
    with pytest.raises(lipofill.InvalidArgumentError, match="--date"):
        connection.reports.make(make_plate(), tmp_path, date="yesterday")
    with pytest.raises(lipofill.InvalidArgumentError, match="healthy"):
        connection.reports.make(make_plate(), tmp_path, healthy_side="middle")
