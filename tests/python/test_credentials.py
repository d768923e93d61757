"""Who calls, and how the way is protected."""

import pytest

import lipofill
from lipofill.credentials import is_local


@pytest.mark.parametrize("server", ["127.0.0.1:1", "localhost:1", "[::1]:1", "unix:/run/lipofill"])
def test_addresses_of_this_machine(server):
    assert is_local(server)


@pytest.mark.parametrize("server", ["10.0.0.5:1", "hospital:1", "[2001:db8::1]:1", "localhost.example.org:1"])
def test_addresses_of_others(server):
    assert not is_local(server)


def test_a_token_does_not_travel_in_plain_text(tmp_path):
    (tmp_path / "token").write_text("secret\n")
    with pytest.raises(ValueError, match="plain text"):
        lipofill.Connection("10.0.0.5:50061", credentials=lipofill.Credentials(token_file=str(tmp_path / "token")))


def test_a_certificate_without_its_key_is_refused():
    with pytest.raises(ValueError, match="belong together"):
        lipofill.Connection(credentials=lipofill.Credentials(certificate_file="me.pem"))


def test_the_token_is_read_for_every_call(tmp_path, daemon):
    (tmp_path / "token").write_text("one\n")
    credentials = lipofill.Credentials(token_file=str(tmp_path / "token"))
    with lipofill.Connection(daemon.server, credentials=credentials) as connection:
        assert connection.metadata() == [("authorization", "Bearer one")]
        assert not list(connection.patients.list())
        (tmp_path / "token").write_text("two")
        assert connection.metadata() == [("authorization", "Bearer two")]


def test_credentials_come_from_the_environment(monkeypatch, tmp_path):
    (tmp_path / "token").write_text("one")
    monkeypatch.setenv("LIPOFILL_TOKEN_FILE", str(tmp_path / "token"))
    monkeypatch.setenv("LIPOFILL_TLS_CA", "ca.pem")
    credentials = lipofill.Credentials.from_environment()
    assert credentials.uses_tls and credentials.metadata() == [("authorization", "Bearer one")]
