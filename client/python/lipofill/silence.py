"""Notices a stream on which nothing comes any more, not even a heartbeat."""

from __future__ import annotations

import threading
import time
from typing import Callable, Optional


class SilenceWatch:
    """Calls `on_silence` once when a wait lasts longer than `limit_s`. Only waits count, not what
    is done between them.
    """

    def __init__(self, limit_s: float, on_silence: Callable[[], object]) -> None:
        self._limit_s = limit_s
        self._on_silence = on_silence
        self._changed = threading.Condition()
        self._waits_since: Optional[float] = None
        self._closed = False
        self.was_silent = False
        self._thread = threading.Thread(target=self._look, name="lipofill-silence", daemon=True)
        self._thread.start()

    def __enter__(self) -> None:
        """A wait begins."""
        with self._changed:
            self._waits_since = time.monotonic()

    def __exit__(self, *_: object) -> None:
        with self._changed:
            self._waits_since = None

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join()

    def _look(self) -> None:
        with self._changed:
            while not self._closed and not self.was_silent:
                since = self._waits_since
                self.was_silent = since is not None and time.monotonic() - since >= self._limit_s
                if not self.was_silent:
                    self._changed.wait(self._limit_s / 4)
        if self.was_silent:
            self._on_silence()
