"""Patients, under pseudonyms."""

from __future__ import annotations

from typing import Iterator, Mapping, Optional

from google.protobuf.field_mask_pb2 import FieldMask

from lipofill.channel import Channel
from lipofill.v1 import patient_service_pb2 as pb


class Patients:
    """The patients of a daemon."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._stub = channel.patient_stub

    def create(
        self, patient_id: str = "", *, display_name: str = "", labels: Optional[Mapping[str, str]] = None
    ) -> pb.Patient:
        """A new patient. Ids, names and labels are pseudonyms: never a person's name.

        Raises
        ------
        AlreadyExistsError
            The id is taken.
        InvalidArgumentError
        """
        request = pb.CreatePatientRequest(patient_id=patient_id, display_name=display_name, labels=labels)
        return self._channel.call(self._stub.CreatePatient, request)

    def get(self, name: str) -> pb.Patient:
        return self._channel.call(self._stub.GetPatient, pb.GetPatientRequest(name=name))

    def list(self) -> Iterator[pb.Patient]:
        """All, by name."""
        return self._channel.paged(self._stub.ListPatients, pb.ListPatientsRequest(), "patients")

    def update(self, patient: pb.Patient, *fields: str) -> pb.Patient:
        """Replaces the fields named, "display_name" and "labels"; both without a name.

        Raises
        ------
        AbortedError
            Someone changed the patient since `patient.etag` was read.
        """
        mask = FieldMask(paths=fields) if fields else None
        return self._channel.call(self._stub.UpdatePatient, pb.UpdatePatientRequest(patient=patient, update_mask=mask))

    def delete(self, name: str, *, force: bool = False) -> None:
        """With `force` its scans and models go with it; without, FailedPreconditionError while it
        has some.
        """
        self._channel.delete(self._stub.DeletePatient, pb.DeletePatientRequest(name=name, force=force))
