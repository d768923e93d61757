"""Who calls, and how the way to the daemon is protected."""

from __future__ import annotations

import ipaddress
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, List, Optional, Tuple

import grpc


def _read(file: str) -> bytes:
    return Path(file).read_bytes()


def is_local(server: str) -> bool:
    """Whether an address is on this machine: a UNIX socket, localhost or a loopback address."""
    if server.startswith("unix:"):
        return True
    host = server.rsplit(":", 1)[0].strip("[]")
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


@dataclass(frozen=True)
class Credentials:
    """What protects the way to the daemon and says who calls. Secrets are in files, never in
    arguments.

    Attributes
    ----------
    ca_file : str or None
        PEM of the authority that the daemon's certificate must come from. Turns TLS on.
    certificate_file, key_file : str or None
        PEM of this client's own certificate and its key, for daemons that ask for one. Both or
        none; turns TLS on.
    token_file : str or None
        A bearer token, sent as ``authorization: Bearer ...`` with every call. Read again for every
        call, so that a token that is renewed in place is taken up.
    server_name : str or None
        The name that the daemon's certificate must have, where it is not the host of the address.
    tls : bool
        TLS with the machine's own authorities, without any of the files above.
    """

    ca_file: Optional[str] = None
    certificate_file: Optional[str] = None
    key_file: Optional[str] = None
    token_file: Optional[str] = None
    server_name: Optional[str] = None
    tls: bool = False

    @classmethod
    def from_environment(cls) -> Credentials:
        """LIPOFILL_TLS_CA, LIPOFILL_TLS_CERT, LIPOFILL_TLS_KEY, LIPOFILL_TOKEN_FILE, as the command
        line takes them.
        """

        def given(name: str) -> Optional[str]:
            return os.environ.get(f"LIPOFILL_{name}") or None

        return cls(given("TLS_CA"), given("TLS_CERT"), given("TLS_KEY"), given("TOKEN_FILE"))

    @property
    def uses_tls(self) -> bool:
        return self.tls or self.ca_file is not None or self.certificate_file is not None

    def check(self, server: str) -> None:
        """Raises ValueError for a certificate without its key, and for a token that would go over a
        network in plain text.
        """
        if (self.certificate_file is None) != (self.key_file is None):
            raise ValueError("certificate_file and key_file belong together")
        if self.token_file is not None and not self.uses_tls and not is_local(server):
            raise ValueError(f"a token would go to {server} in plain text; give ca_file, or tls=True")

    def open_channel(self, server: str, options: List[Tuple[str, Any]]) -> Any:
        """A grpc.Channel to the daemon."""
        self.check(server)
        if not self.uses_tls:
            return grpc.insecure_channel(server, options)
        if self.server_name is not None:
            options = [*options, ("grpc.ssl_target_name_override", self.server_name)]
        secrets = grpc.ssl_channel_credentials(
            root_certificates=_read(self.ca_file) if self.ca_file else None,
            private_key=_read(self.key_file) if self.key_file else None,
            certificate_chain=_read(self.certificate_file) if self.certificate_file else None,
        )
        return grpc.secure_channel(server, secrets, options)

    def metadata(self) -> List[Tuple[str, str]]:
        """What goes with every call."""
        if self.token_file is None:
            return []
        return [("authorization", f"Bearer {_read(self.token_file).decode().strip()}")]
