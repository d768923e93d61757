"""The package: its types hold, it installs, it documents itself."""

import inspect
import os
import pathlib
import subprocess
import sys

import pytest

import lipofill
from conftest import SOURCE

BUILT = pathlib.Path(os.path.abspath(lipofill.__file__)).parents[1]
MYPY = pathlib.Path("/usr/bin/mypy")


def mypy(*arguments, cwd=BUILT):
    cache = os.environ.get("TMPDIR", "/tmp") + "/lipofill-mypy"
    command = [MYPY, "--config-file", BUILT / "pyproject.toml", "--cache-dir", cache, *arguments]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, env={**os.environ, "MYPYPATH": str(BUILT)})


@pytest.mark.skipif(not MYPY.exists(), reason="mypy is not installed")
def test_the_types_hold(tmp_path):
    done = mypy("-p", "lipofill")
    assert done.returncode == 0, done.stdout
    lift = "def lift(run: lipofill.Run) -> float:\n    return run.wait().summary.skin_max_displacement_mm\n"
    user = f"import lipofill\n\n{lift}"
    (tmp_path / "user.py").write_text(user)
    assert mypy(str(tmp_path / "user.py")).returncode == 0
    wrong = user + "\nlipofill.Plan('a').inject('b', volume='1')\nlipofill.Connection().patients.get(1)\n"
    (tmp_path / "wrong.py").write_text(wrong)
    complaints = mypy(str(tmp_path / "wrong.py")).stdout
    assert 'Unexpected keyword argument "volume"' in complaints and "incompatible type" in complaints


def test_the_package_installs(tmp_path):
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation", "--no-index"]
    source = tmp_path / "source"
    subprocess.run(["cp", "-rL", str(BUILT), str(source)], check=True)
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        [*pip, "--target", tmp_path / "site", source], capture_output=True, text=True, env=environment
    )
    assert done.returncode == 0, done.stderr
    for name in ("py.typed", "v1/plan_pb2.pyi", "v1/frame_service_pb2_grpc.pyi", "google_rpc/own/status_pb2.py"):
        assert (tmp_path / "site" / "lipofill" / name).exists(), name
    program = "import lipofill, lipofill.v1.plan_pb2; print(lipofill.Plan('a').square(1, 1, n_xi=1, n_eta=1).to_json())"
    command = [sys.executable, "-c", program]
    environment["PYTHONPATH"] = str(tmp_path / "site")
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, env=environment)
    assert done.returncode == 0 and "length_xi_mm" in done.stdout, done.stderr


def public_names():
    for name in lipofill.__all__:
        thing = getattr(lipofill, name)
        yield pytest.param(thing, id=name)


@pytest.mark.parametrize("thing", public_names())
def test_everything_public_says_what_it_is(thing):
    assert inspect.getdoc(thing), thing


def test_the_version_is_that_of_the_project():
    project = (SOURCE / "CMakeLists.txt").read_text().split("project(lipofill VERSION ")[1].split()[0]
    assert lipofill.__version__ == project
    assert f'version = "{project}"' in (SOURCE / "client" / "python" / "pyproject.toml").read_text()
