"""Plans that are proposed for a target, and their injection lists."""

import pytest

import lipofill
from conftest import PLANS
from lipofill.v1 import planning_service_pb2 as pb


@pytest.fixture(scope="module")
def case(connection, tmp_path_factory):
    """The sample face, its model, and as target the face 3 mm larger around its centre."""
    plan = lipofill.Plan.load(PLANS / "jaw_angle.json")
    scan_file = PLANS.parent / "faces" / "half_face.obj"
    lines = []
    for line in scan_file.read_text().splitlines():
        if line.startswith("v "):
            x, y, z = (float(word) for word in line.split()[1:4])
            line = f"v {x * 1.03:.4f} {y * 1.03:.4f} {z * 1.03:.4f}"
        lines.append(line)
    target_file = tmp_path_factory.mktemp("target") / "target.obj"
    target_file.write_text("\n".join(lines) + "\n")
    with connection.run(plan) as run:
        model = run.get().spec.model
        patient = "/".join(model.split("/")[:2])
        target = connection.scans.upload(patient, target_file)
        yield run.get().spec, patient, target.name


def test_a_proposal_fills_what_is_missing(connection, case):
    plan, patient, target = case
    stages = []
    spec = pb.ProposalSpec(plan=plan, target_scan=target, curve_points=2)
    spec.bounds.max_total_ml = 3.0
    proposal = connection.proposals.propose(patient, spec, progress=lambda progress: stages.append(progress))
    assert proposal.total_ml <= 3.0
    assert proposal.reached.skin_to_target.rms_mm < proposal.before.skin_to_target.rms_mm
    assert stages and proposal.solves > 2


def test_a_delivery_lists_the_volumes(connection, case):
    plan, _, _ = case
    delivery = connection.proposals.deliver(plan, max_pass_ml=0.1)
    assert sum(entry.volume_ml for entry in delivery.entries) == pytest.approx(4.5)
    assert max(step.volume_ml for step in delivery.passes) <= 0.1 + 1e-12


def test_what_is_wrong_is_named(connection, case):
    plan, patient, target = case
    spec = pb.ProposalSpec(plan=plan, target_scan=target)
    spec.bounds.max_pressure_pa = -1.0
    with pytest.raises(lipofill.InvalidArgumentError, match="max_pressure_pa"):
        connection.proposals.propose(patient, spec)
