"""Plans that are kept, through the package and the real daemon."""

import pytest

import lipofill


@pytest.fixture
def patient(connection):
    made = connection.patients.create()
    yield made.name
    connection.patients.delete(made.name, force=True)


def test_a_plan_is_kept_changed_and_told_of(connection, plate, patient):
    saved = connection.plans.save(patient, plate, title="plate", side="left")
    assert saved.name.startswith(patient + "/plans/") and saved.revision == 1
    assert connection.plans.get(saved.name).content == plate.message
    assert [plan.name for plan in connection.plans.list(patient, "name")] == [saved.name]
    assert saved.name in [plan.name for plan in connection.plans.list()]

    saved.content.simulation.injections[0].volume_ml = 0.7
    changed = connection.plans.update(saved, "content")
    assert changed.revision == 2 and changed.title == "plate"
    first, second = reversed(list(connection.plans.history(saved.name)))
    assert list(first.changes) == []
    assert list(second.changes) == ["content.simulation.injections[0].volume_ml was 0.3, is 0.7"]
    assert connection.plans.get(saved.name, revision=1).content == plate.message
    connection.plans.delete(saved.name)
    with pytest.raises(lipofill.NotFoundError):
        connection.plans.get(saved.name)


def test_the_later_of_two_edits_is_an_error_that_names_the_field(connection, plate, patient):
    saved = connection.plans.save(patient, plate)
    other = connection.plans.get(saved.name)
    other.title = "mine"
    connection.plans.update(other)
    saved.content.simulation.injections[0].volume_ml = 0.9
    with pytest.raises(lipofill.AbortedError) as late:
        connection.plans.update(saved)
    assert {violation.field for violation in late.value.violations} == {"plan.etag", "plan.title"}


def test_a_plan_knows_its_runs(connection, plate, patient):
    saved = connection.plans.save(patient, plate)
    with connection.run(plate, patient=patient) as run:
        noted = connection.plans.add_run(saved.name, run.name)
        assert [entry.simulation for entry in noted.runs] == [run.name]
        assert noted.runs[0].content_hash == saved.content_hash
    assert not connection.plans.get(saved.name).runs, "what was run is gone from the daemon, and from the plan"


def test_a_side_that_is_none_is_refused(connection, plate, patient):
    with pytest.raises(lipofill.InvalidArgumentError, match="must be one of left, right, both"):
        connection.plans.save(patient, plate, side="up")
