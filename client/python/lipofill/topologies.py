"""The meshes that a connection has seen, so that they come once."""

from __future__ import annotations

import threading
from collections import OrderedDict
from typing import Optional, Tuple

from lipofill.frames import Meshes
from lipofill.v1 import frame_service_pb2 as pb

_Key = Tuple[str, Tuple[str, ...], Tuple[str, ...]]


class Topologies:
    """The last meshes of the last simulations that were watched, a set for each choice of meshes
    and fields. Thread-safe.
    """

    def __init__(self, most: int = 16) -> None:
        self._most = most
        self._lock = threading.Lock()
        self._kept: OrderedDict[_Key, Meshes] = OrderedDict()

    def get(self, request: pb.WatchRequest) -> Optional[Meshes]:
        with self._lock:
            return self._kept.get(self._key(request))

    def remember(self, request: pb.WatchRequest, meshes: Meshes) -> None:
        key = self._key(request)
        with self._lock:
            self._kept[key] = meshes
            self._kept.move_to_end(key)
            while len(self._kept) > self._most:
                self._kept.popitem(last=False)

    @staticmethod
    def _key(request: pb.WatchRequest) -> _Key:
        return request.simulation, tuple(request.meshes), tuple(request.fields)
