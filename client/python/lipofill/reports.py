"""A report of a plan: all that is known of it, to read, to print, and as figures.

The page is made by the program ``lipofill`` on this machine, as ``lipofill report`` makes it, from
what the daemon of the connection answers: the same bytes, the same figures.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Dict, List, Optional, Union

from google.protobuf.json_format import MessageToJson

from lipofill.channel import Channel
from lipofill.errors import (
    CancelledError,
    FailedPreconditionError,
    InvalidArgumentError,
    LipofillError,
    UnavailableError,
)
from lipofill.plans import Plan
from lipofill.v1 import forecast_service_pb2
from lipofill.volumes import PathLike, find_program

#: By exit code, as `lipofill --help` tells them.
_ERRORS = {2: InvalidArgumentError, 3: UnavailableError, 4: FailedPreconditionError, 130: CancelledError}


def _message_of(output: str) -> str:
    try:
        return str(json.loads(output[output.index('{"error"') :])["error"]["message"])
    except (ValueError, KeyError, TypeError):
        return output.strip()


class Reports:
    """Makes reports. Each makes its own model from the plan's scan, and leaves nothing on the
    daemon.
    """

    def __init__(self, channel: Channel) -> None:
        self._channel = channel

    def make(
        self,
        plan: Union[Plan, PathLike],
        out: PathLike,
        *,
        target: Optional[str] = None,
        target_landmarks: Optional[PathLike] = None,
        in_place: bool = False,
        healthy_side: Optional[str] = None,
        forecast: Optional[forecast_service_pb2.ForecastSpec] = None,
        without_forecast: bool = False,
        patient: Optional[str] = None,
        pseudonym: Optional[str] = None,
        date: Optional[str] = None,
        language: str = "en",
        paper: str = "a4",
        pdf: bool = True,
    ) -> Dict[str, Any]:
        """Writes report.html, report.csv, report.json and, where Chromium is installed, report.pdf
        into a folder.

        Parameters
        ----------
        plan : Plan or path
            A plan or its file.
        out : path
            The folder; made when missing.
        target : str, optional
            The face as it should be: a surface file, or ``patients/{patient}/scans/{scan}``.
        healthy_side : {"left", "right"}, optional
            Mirror this side, the subject's own, for a target.
        forecast : ForecastSpec, optional
            Members, inputs, retention, months, follow-up; without its plan. Default: a forecast's.
        without_forecast : bool
            Figures without intervals, in a fraction of the time.
        date : str, optional
            The day on the report, ``YYYY-MM-DD``; default: today.

        Returns
        -------
        dict
            The record that the page was made of, as in report.json.

        Raises
        ------
        InvalidArgumentError, FailedPreconditionError
            As the message says, which names options as ``lipofill report`` has them.
        FileNotFoundError
            There is no program ``lipofill``.
        """
        with tempfile.TemporaryDirectory(prefix="lipofill-") as folder:
            arguments = self._arguments(plan, Path(folder), forecast)
            given = {
                "--out": out,
                "--target": target,
                "--target-landmarks": target_landmarks,
                "--healthy": healthy_side,
                "--patient": patient,
                "--pseudonym": pseudonym,
                "--date": date,
                "--language": language,
                "--paper": paper,
            }
            for option, value in given.items():
                if value is not None:
                    arguments += [option, str(value)]
            switches = {"--in-place": in_place, "--no-forecast": without_forecast, "--no-pdf": not pdf}
            arguments += [option for option, is_on in switches.items() if is_on]
            return self._run(arguments)

    def data(self, plan: Union[Plan, PathLike], **options: Any) -> Dict[str, Any]:
        """The record alone, as report.json has it, without files: options as those of ``make``."""
        options["pdf"] = False
        with tempfile.TemporaryDirectory(prefix="lipofill-") as folder:
            return self.make(plan, folder, **options)

    def _arguments(
        self, plan: Union[Plan, PathLike], folder: Path, forecast: Optional[forecast_service_pb2.ForecastSpec]
    ) -> List[str]:
        file = Path(folder) / "plan.json" if isinstance(plan, Plan) else Path(plan)
        if isinstance(plan, Plan):
            plan.save(file)
        arguments = ["report", str(file), "--server", self._channel.server, *self._credentials()]
        if forecast is not None:
            settings = folder / "forecast.json"
            settings.write_text(MessageToJson(forecast, preserving_proto_field_name=True), encoding="utf-8")
            arguments += ["--settings", str(settings)]
        return arguments

    def _credentials(self) -> List[str]:
        credentials = self._channel.credentials
        files = {
            "--token-file": credentials.token_file,
            "--tls-ca": credentials.ca_file,
            "--tls-cert": credentials.certificate_file,
            "--tls-key": credentials.key_file,
        }
        return [word for option, file in files.items() if file is not None for word in (option, file)]

    def _run(self, arguments: List[str]) -> Dict[str, Any]:
        result = subprocess.run(
            [find_program(), *arguments, "--quiet", "--json"],
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
        if result.returncode != 0:
            raise _ERRORS.get(result.returncode, LipofillError)(_message_of(result.stderr or result.stdout))
        record: Dict[str, Any] = json.loads(result.stdout)
        return record
