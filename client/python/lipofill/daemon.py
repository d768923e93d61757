"""A private daemon: for scripts and tests that bring their own."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path
from types import TracebackType
from typing import List, Optional, Sequence, Type, Union

import grpc

from lipofill.connection import Connection
from lipofill.errors import UnavailableError

_START_S = 30.0
_STOP_S = 40.0
_CONNECT_S = 0.1


def find_program() -> str:
    """lipofilld: $LIPOFILLD, or of the build tree that this package is in, or on PATH."""
    beside = Path(__file__).resolve().parents[0]
    built = Path(os.path.abspath(__file__)).parents[2] / "bin" / "lipofilld"
    for candidate in (os.environ.get("LIPOFILLD"), str(built), str(beside / "lipofilld"), shutil.which("lipofilld")):
        if candidate and os.access(candidate, os.X_OK):
            return candidate
    raise FileNotFoundError("no lipofilld: build or install it, or name it by LIPOFILLD")


class Daemon:
    """A lipofilld of one's own on a UNIX socket, that ends with the context.

        with lipofill.Daemon() as daemon, daemon.connect() as connection:
            ...

    Parameters
    ----------
    data : path, optional
        Its data directory; default: a temporary one that goes with it.
    arguments : sequence of str
        More of its command line, for example ``["--workers", "4"]``.
    """

    def __init__(self, data: Optional[Union[str, os.PathLike[str]]] = None, arguments: Sequence[str] = ()) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="lipofill-")
        folder = Path(self._folder.name)
        self.data = Path(data) if data is not None else folder / "data"
        self.log_file = folder / "log"
        self.server = f"unix:{folder / 'socket'}"
        self._arguments = list(arguments)
        self._process: Optional[subprocess.Popen[bytes]] = None

    def __enter__(self) -> Daemon:
        self.start()
        return self

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        self.stop()
        self._folder.cleanup()

    @property
    def pid(self) -> int:
        assert self._process is not None, "the daemon has not been started"
        return self._process.pid

    def is_running(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def log(self) -> str:
        return self.log_file.read_text(errors="replace") if self.log_file.exists() else ""

    def connect(self) -> Connection:
        """A connection to it."""
        return Connection(self.server)

    def start(self) -> None:
        """Starts it and waits until it serves.

        Raises
        ------
        UnavailableError
            It does not serve, with the end of its log.
        """
        command: List[str] = [find_program(), "--listen", self.server, "--data", str(self.data), *self._arguments]
        with open(self.log_file, "ab") as log:
            self._process = subprocess.Popen(command, stdout=log, stderr=log, start_new_session=True)
        deadline = time.monotonic() + _START_S
        while not self._serves():
            if not self.is_running() or time.monotonic() > deadline:
                self.kill()
                raise UnavailableError(f"lipofilld does not serve:\n{self.log()[-2000:]}")

    def _serves(self) -> bool:
        with grpc.insecure_channel(self.server, [("grpc.initial_reconnect_backoff_ms", 20)]) as channel:
            try:
                grpc.channel_ready_future(channel).result(timeout=_CONNECT_S)
            except grpc.FutureTimeoutError:
                return False
        return True

    def stop(self) -> int:
        """Asks it to end, and waits; its exit code."""
        if self._process is None:
            return 0
        if self.is_running():
            self._process.terminate()
        try:
            return self._process.wait(_STOP_S)
        except subprocess.TimeoutExpired:
            return self.kill()

    def kill(self) -> int:
        """Ends it at once, as a crash would (SIGKILL). What it acknowledged is there after the next
        ``start``.
        """
        if self.is_running():
            self.signal(signal.SIGKILL)
        return self._process.wait() if self._process is not None else 0

    def signal(self, number: signal.Signals) -> None:
        assert self._process is not None, "the daemon has not been started"
        self._process.send_signal(number)
