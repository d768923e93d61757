"""Records of a plan in a real PACS: a CT goes into Orthanc, is found, fetched and planned on, and
the results go back and are read again byte for byte.
"""

import contextlib
import json
import os
import pathlib
import shutil
import socket
import struct
import subprocess
import time
import urllib.request
from typing import Any, Dict, Iterator, List, Tuple

import numpy
import pytest

from conftest import PLANS

ORTHANC = shutil.which("Orthanc", path=os.environ.get("PATH", "") + ":/usr/sbin")
STUDY, SERIES, FRAME = "1.2.826.0.1.3680043.9.9999.31", "1.2.826.0.1.3680043.9.9999.32", "1.2.826.0.1.3680043.9.9999.33"
CENTRE_MM, RADIUS_MM = (0.0, 0.0, 40.0), 60.0
SPACING_MM, SIZE = (2.0, 2.0, 2.5), (80, 80, 60)
ORIGIN_MM = (-79.0, -79.0, -33.75)
PDF = b"%PDF-1.4\n% A report of an odd number of bytes, which DICOM pads.\n%%EOF\n"

pytestmark = pytest.mark.skipif(ORTHANC is None, reason="Orthanc is not installed")


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port: int = one.getsockname()[1]
        return port


class Orthanc:
    """A PACS of the test's own."""

    def __init__(self, folder: pathlib.Path, **more: Any) -> None:
        self.http, self.dicom = free_port(), free_port()
        self.address = f"TESTPACS@127.0.0.1:{self.dicom}"
        settings = {
            "Name": "test",
            "StorageDirectory": str(folder / "storage"),
            "IndexDirectory": str(folder / "storage"),
            "HttpPort": self.http,
            "DicomPort": self.dicom,
            "DicomAet": "TESTPACS",
            "DicomCheckCalledAet": True,
            "RemoteAccessAllowed": False,
            "DicomAlwaysAllowEcho": True,
            "DicomAlwaysAllowFind": True,
            "DicomAlwaysAllowGet": True,
            "DicomAlwaysAllowStore": True,
            "UnknownSopClassAccepted": True,
            "Plugins": [],
            **more,
        }
        (folder / "orthanc.json").write_text(json.dumps(settings))
        self._log = open(folder / "orthanc.log", "wb")
        assert ORTHANC is not None
        self._process = subprocess.Popen([ORTHANC, str(folder / "orthanc.json")], stdout=self._log, stderr=self._log)
        deadline = time.monotonic() + 60
        while not self._serves():
            assert self._process.poll() is None and time.monotonic() < deadline, (folder / "orthanc.log").read_text()
            time.sleep(0.1)

    def _serves(self) -> bool:
        try:
            return bool(self.get("/system")["Version"])
        except OSError:
            return False

    def raw(self, path: str) -> bytes:
        with urllib.request.urlopen(f"http://127.0.0.1:{self.http}{path}", timeout=20) as answer:
            content: bytes = answer.read()
            return content

    def get(self, path: str) -> Any:
        return json.loads(self.raw(path))

    def close(self) -> None:
        self._process.terminate()
        self._process.wait(30)
        self._log.close()


@pytest.fixture(scope="module")
def pacs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Orthanc]:
    made = Orthanc(tmp_path_factory.mktemp("pacs"))
    yield made
    made.close()


def element(group: int, number: int, kind: str, value: Any) -> bytes:
    """One element of explicit little endian."""
    data = struct.pack("<H", value) if isinstance(value, int) else value.encode() if isinstance(value, str) else value
    if len(data) % 2 == 1:
        data += b"\0" if kind == "UI" else b" "
    head = struct.pack("<HH", group, number) + kind.encode()
    if kind in ("OB", "OW"):
        return head + struct.pack("<HI", 0, len(data)) + data
    return head + struct.pack("<H", len(data)) + data


def ct_slice(k: int) -> bytes:
    """Slice k of a ball of tissue as large as a head."""
    x, y = (ORIGIN_MM[axis] + SPACING_MM[axis] * numpy.arange(SIZE[axis]) for axis in (0, 1))
    z = ORIGIN_MM[2] + SPACING_MM[2] * k
    distance = numpy.sqrt((x[None, :]) ** 2 + (y[:, None]) ** 2 + (z - CENTRE_MM[2]) ** 2)
    pixels = numpy.clip(-500 + 100 * (RADIUS_MM - distance), -1000, 40).astype("<i2")
    uid = f"{SERIES}.{k + 1}"
    elements = [
        (0x0008, 0x0005, "CS", "ISO_IR 100"),
        (0x0008, 0x0008, "CS", "ORIGINAL\\PRIMARY\\AXIAL"),
        (0x0008, 0x0016, "UI", "1.2.840.10008.5.1.4.1.1.2"),
        (0x0008, 0x0018, "UI", uid),
        (0x0008, 0x0020, "DA", "20240304"),
        (0x0008, 0x0030, "TM", "101500"),
        (0x0008, 0x0050, "SH", "ACC7"),
        (0x0008, 0x0060, "CS", "CT"),
        (0x0008, 0x0070, "LO", "A scanner"),
        (0x0008, 0x0090, "PN", "DOCTOR^SECRET"),
        (0x0008, 0x103E, "LO", "Head"),
        (0x0010, 0x0010, "PN", "JANE^SECRET"),
        (0x0010, 0x0020, "LO", "4711"),
        (0x0010, 0x0030, "DA", "19700102"),
        (0x0010, 0x0040, "CS", "F"),
        (0x0020, 0x000D, "UI", STUDY),
        (0x0020, 0x000E, "UI", SERIES),
        (0x0020, 0x0010, "SH", "S1"),
        (0x0020, 0x0011, "IS", "4"),
        (0x0020, 0x0013, "IS", str(k + 1)),
        (0x0020, 0x0032, "DS", f"{ORIGIN_MM[0]}\\{ORIGIN_MM[1]}\\{z}"),
        (0x0020, 0x0037, "DS", "1\\0\\0\\0\\1\\0"),
        (0x0020, 0x0052, "UI", FRAME),
        (0x0028, 0x0002, "US", 1),
        (0x0028, 0x0004, "CS", "MONOCHROME2"),
        (0x0028, 0x0010, "US", SIZE[1]),
        (0x0028, 0x0011, "US", SIZE[0]),
        (0x0028, 0x0030, "DS", f"{SPACING_MM[1]}\\{SPACING_MM[0]}"),
        (0x0028, 0x0100, "US", 16),
        (0x0028, 0x0101, "US", 16),
        (0x0028, 0x0102, "US", 15),
        (0x0028, 0x0103, "US", 1),
        (0x0028, 0x1052, "DS", "0"),
        (0x0028, 0x1053, "DS", "1"),
        (0x7FE0, 0x0010, "OW", pixels.tobytes()),
    ]
    meta = b"".join(
        element(0x0002, *each)
        for each in [
            (0x0001, "OB", b"\0\1"),
            (0x0002, "UI", "1.2.840.10008.5.1.4.1.1.2"),
            (0x0003, "UI", uid),
            (0x0010, "UI", "1.2.840.10008.1.2.1"),
            (0x0012, "UI", "1.2.826.0.1.3680043.9.9999"),
        ]
    )
    meta = element(0x0002, 0x0000, "UL", struct.pack("<I", len(meta))) + meta
    return b"\0" * 128 + b"DICM" + meta + b"".join(element(*each) for each in elements)


def run(*arguments: Any, code: int = 0) -> "subprocess.CompletedProcess[str]":
    command = [os.environ["LIPOFILL"], *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=200)
    assert done.returncode == code, (command, done.stdout, done.stderr)
    return done


def answer(*arguments: Any) -> Dict[str, Any]:
    parsed: Dict[str, Any] = json.loads(run(*arguments, "--json").stdout)
    return parsed


def data_set_of(file: bytes) -> bytes:
    """What comes after the meta header of a file of DICOM, which belongs to whoever wrote it."""
    length: int = struct.unpack("<I", file[140:144])[0]
    return file[144 + length :]


def plan_on(skin: pathlib.Path) -> Dict[str, Any]:
    """Fat under the front of the ball; its corners are points of the surface."""
    corners = []
    for x, z in ((-30, 15), (30, 15), (30, 65), (-30, 65)):
        y = -numpy.sqrt(RADIUS_MM**2 - x**2 - (z - CENTRE_MM[2]) ** 2)
        corners.append({"position_mm": {"x": x, "y": float(y), "z": z}})
    layer = {"elements_through": 1, "poisson_ratio": 0.45, "density_kg_m3": 1050}
    return {
        "name": "ball",
        "scan": {"file": str(skin), "unit": "MILLIMETRE"},
        "model": {
            "scan_region": {"corners": corners},
            "n_xi": 16,
            "n_eta": 14,
            "layers": [
                {"name": "skin", "thickness_mm": {"constant": 3}, "youngs_modulus_kpa": 60, **layer},
                {"name": "muscle", "thickness_mm": {"constant": 6}, "youngs_modulus_kpa": 60, **layer},
            ],
            "rim": {"kind": "CLAMPED"},
            "base": {"kind": "CLAMPED"},
        },
        "simulation": {
            "fat": {"viscosity_pa_s": 15},
            "films": [
                {
                    "name": "deep",
                    "below_layer": "skin",
                    "zones": [
                        {"name": "front", "box": {"xi_min": 0.25, "xi_max": 0.75, "eta_min": 0.25, "eta_max": 0.75}}
                    ],
                }
            ],
            "injections": [{"zone": "front", "volume_ml": 2.5, "rate_ml_per_s": 1}],
            "time": {"step_ms": 10, "end_s": 120, "goal": "SETTLED_SHAPE"},
        },
    }


@pytest.fixture(scope="module")
def journey(pacs: Orthanc, tmp_path_factory: pytest.TempPathFactory) -> Dict[str, Any]:
    """From the scanner to the PACS and back, once for all tests."""
    folder = tmp_path_factory.mktemp("journey")
    (folder / "scanner").mkdir()
    for k in range(SIZE[2]):
        (folder / "scanner" / f"{k:03d}.dcm").write_bytes(ct_slice(k))
    run("records", "send", "--pacs", pacs.address, *sorted((folder / "scanner").iterdir()))
    found = answer("records", "find", "--pacs", pacs.address, "--patient-id", "47*", "--modality", "CT")
    fetch = ("--study", STUDY, "--series", SERIES, "--out", folder / "ct")
    fetched = answer("records", "fetch", "--pacs", pacs.address, *fetch)
    run("scan", "extract", folder / "ct", "--isovalue", -500, "--out", folder / "skin.ply")
    (folder / "plan.json").write_text(json.dumps(plan_on(folder / "skin.ply")))
    run("run", folder / "plan.json", "--out", folder / "result", "--spawn")
    (folder / "report.pdf").write_bytes(PDF)
    make = ("records", "make", folder / "result", "--study", folder / "ct", "--pdf", folder / "report.pdf", "--out")
    made = answer(*make, folder / "records")
    run(*make, folder / "again")
    files = [pathlib.Path(each["file"]) for each in made["files"]]
    run("records", "send", "--pacs", pacs.address, *files)
    run("records", "fetch", "--pacs", pacs.address, "--study", STUDY, "--out", folder / "back")
    return {"folder": folder, "found": found, "fetched": fetched, "made": made, "files": files}


def test_the_ct_is_found_and_fetched_as_it_was_sent(journey: Dict[str, Any]) -> None:
    (series,) = journey["found"]["series"]
    assert series["study_uid"] == STUDY and series["series_uid"] == SERIES and series["study_date"] == "20240304"
    assert series["modality"] == "CT" and series["description"] == "Head" and series["images"] == str(SIZE[2])
    assert "SECRET" not in json.dumps(journey["found"])
    assert journey["fetched"]["files"] == SIZE[2]
    back = {data_set_of(file.read_bytes()) for file in (journey["folder"] / "ct").iterdir()}
    assert back == {data_set_of(ct_slice(k)) for k in range(SIZE[2])}


def test_results_come_back_byte_for_byte(journey: Dict[str, Any]) -> None:
    sent = {data_set_of(file.read_bytes()) for file in journey["files"]}
    back = {data_set_of(file.read_bytes()) for file in (journey["folder"] / "back").iterdir()}
    assert len(sent) == 4 and sent <= back and len(back) == SIZE[2] + 4
    assert any(PDF in data for data in back)


def test_the_pacs_shows_them_in_the_study_they_belong_to(journey: Dict[str, Any], pacs: Orthanc) -> None:
    (study,) = pacs.get("/studies?expand")
    assert study["MainDicomTags"]["StudyInstanceUID"] == STUDY
    assert study["PatientMainDicomTags"]["PatientID"] == "4711"
    series = [pacs.get(f"/series/{each}") for each in study["Series"]]
    modalities = {each["MainDicomTags"]["Modality"]: each for each in series}
    assert set(modalities) == {"CT", "DOC", "M3D", "SR", "SEG"}
    assert all(len(each["Instances"]) == 1 for kind, each in modalities.items() if kind != "CT")
    assert pacs.raw(f"/instances/{modalities['DOC']['Instances'][0]}/pdf") == PDF
    tags = pacs.get(f"/instances/{modalities['SEG']['Instances'][0]}/simplified-tags")
    assert tags["PatientName"] == "JANE^SECRET" and tags["FrameOfReferenceUID"] == FRAME
    assert tags["SegmentSequence"][0]["SegmentLabel"] == "Planned fat: film"


def test_the_fat_has_its_volume_and_lies_under_the_front(journey: Dict[str, Any], pacs: Orthanc) -> None:
    summary = json.loads((journey["folder"] / "result" / "summary.json").read_text())
    (study,) = pacs.get("/studies?expand")
    for name in study["Series"]:
        series = pacs.get(f"/series/{name}")
        if series["MainDicomTags"]["Modality"] == "SEG":
            instance = series["Instances"][0]
    tags = pacs.get(f"/instances/{instance}/simplified-tags")
    file = pacs.raw(f"/instances/{instance}/file")
    packed = file[file.rindex(struct.pack("<HH", 0x7FE0, 0x0010)) + 12 :]
    frames = int(tags["NumberOfFrames"])
    bits = numpy.unpackbits(numpy.frombuffer(packed, dtype=numpy.uint8), bitorder="little")
    labels = bits[: frames * SIZE[0] * SIZE[1]].reshape(frames, SIZE[1], SIZE[0])
    volume_ml = labels.sum() * SPACING_MM[0] * SPACING_MM[1] * SPACING_MM[2] / 1000
    assert volume_ml == pytest.approx(summary["film_volume_ml"], rel=0.25)
    frame, row, column = (index.mean() for index in numpy.nonzero(labels))
    heights = [
        float(each["PlanePositionSequence"][0]["ImagePositionPatient"].split("\\")[2])
        for each in tags["PerFrameFunctionalGroupsSequence"]
    ]
    middle = (ORIGIN_MM[0] + SPACING_MM[0] * column, ORIGIN_MM[1] + SPACING_MM[1] * row, numpy.mean(heights))
    assert middle[0] == pytest.approx(0, abs=3) and -62 < middle[1] < -48 and middle[2] == pytest.approx(40, abs=4)


def test_the_same_result_gives_the_same_files(journey: Dict[str, Any]) -> None:
    for file in journey["files"]:
        assert file.read_bytes() == (journey["folder"] / "again" / file.name).read_bytes(), file.name


def test_nothing_of_the_patient_is_said(journey: Dict[str, Any]) -> None:
    folder = journey["folder"]
    made = run("records", "make", folder / "result", "--study", folder / "ct", "--out", folder / "more")
    assert "SECRET" not in made.stdout + made.stderr and "4711" not in made.stdout + made.stderr
    for file in (folder / "result").iterdir():
        if file.is_file():
            assert b"SECRET" not in file.read_bytes() and b"19700102" not in file.read_bytes(), file.name


@pytest.mark.skipif(shutil.which("dciodvfy") is None, reason="dicom3tools is not installed")
def test_the_objects_are_what_dicom_says(journey: Dict[str, Any]) -> None:
    for file in journey["files"]:
        done = subprocess.run(["dciodvfy", str(file)], capture_output=True, text=True, check=False)
        errors: List[str] = [line for line in (done.stdout + done.stderr).splitlines() if line.startswith("Error")]
        assert not errors, (file.name, errors)


def test_a_pacs_that_is_not_there_or_does_not_know_us_is_told(pacs: Orthanc, tmp_path: pathlib.Path) -> None:
    assert "cannot reach" in run("records", "find", "--pacs", f"A@127.0.0.1:{free_port()}", code=3).stderr
    wrong = run("records", "find", "--pacs", f"OTHER@127.0.0.1:{pacs.dicom}", code=4)
    assert "does not let LIPOFILL in" in wrong.stderr
    none = ("records", "fetch", "--pacs", pacs.address, "--study", "1.2.3", "--out", tmp_path / "none")
    assert "it may not have that study" in run(*none, code=4).stderr
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "file").write_text("here")
    full = run("records", "fetch", "--pacs", pacs.address, "--study", STUDY, "--out", tmp_path / "full", code=2)
    assert "is not empty" in full.stderr
    assert "TITLE@HOST:PORT" in run("records", "find", "--pacs", "nowhere", code=2).stderr
    (tmp_path / "text.dcm").write_text("no DICOM")
    text = run("records", "send", "--pacs", pacs.address, tmp_path / "text.dcm", code=2)
    assert "is not a file of DICOM" in text.stderr


def test_records_of_another_face_are_refused(journey: Dict[str, Any], tmp_path: pathlib.Path) -> None:
    run("run", PLANS / "jaw_angle.json", "--out", tmp_path / "jaw", "--spawn", "--fast")
    make = ("records", "make", tmp_path / "jaw", "--study", journey["folder"] / "ct", "--out", tmp_path / "no")
    done = run(*make, code=2)
    assert "of the planned skin lie outside of the series" in done.stderr


DICOMWEB = pathlib.Path("/usr/share/orthanc/plugins/libOrthancDicomWeb.so")


def web_archive(folder: pathlib.Path, **more: Any) -> Orthanc:
    folder.mkdir()
    return Orthanc(folder, Plugins=[str(DICOMWEB)], DicomWeb={"Enable": True, "Root": "/dicom-web/"}, **more)


NGINX = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin")


@contextlib.contextmanager
def tls_front(folder: pathlib.Path, port: int) -> Iterator[Tuple[int, pathlib.Path]]:
    """TLS before a service, as clinics have it: its port, and the certificate that it shows."""
    key, certificate = folder / "key.pem", folder / "certificate.pem"
    subject = ("-subj", "/CN=127.0.0.1", "-addext", "subjectAltName=IP:127.0.0.1", "-days", "2")
    files = ("-keyout", str(key), "-out", str(certificate))
    make = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", *files, *subject]
    subprocess.run(make, check=True, capture_output=True)
    front = free_port()
    (folder / "nginx.conf").write_text(f"""
        daemon off;
        {"user root;" if os.geteuid() == 0 else ""}
        pid {folder}/pid;
        error_log {folder}/error.log;
        events {{}}
        http {{
          access_log off;
          client_max_body_size 0;
          client_body_temp_path {folder}/body;
          proxy_temp_path {folder}/proxy;
          fastcgi_temp_path {folder}/f;
          uwsgi_temp_path {folder}/u;
          scgi_temp_path {folder}/s;
          server {{
            listen 127.0.0.1:{front} ssl;
            ssl_certificate {certificate};
            ssl_certificate_key {key};
            location / {{ proxy_pass http://127.0.0.1:{port}; }}
          }}
        }}""")
    assert NGINX is not None
    process = subprocess.Popen([NGINX, "-p", str(folder), "-c", str(folder / "nginx.conf")], stderr=subprocess.DEVNULL)
    try:
        deadline = time.monotonic() + 30
        while True:
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", front), timeout=1):
                break
            assert process.poll() is None and time.monotonic() < deadline, (folder / "error.log").read_text()
            time.sleep(0.1)
        yield front, certificate
    finally:
        process.terminate()
        process.wait(30)


@pytest.mark.skipif(not DICOMWEB.exists() or NGINX is None, reason="orthanc-dicomweb or nginx is not installed")
def test_results_go_to_a_web_service_over_tls(journey: Dict[str, Any], tmp_path: pathlib.Path) -> None:
    archive = web_archive(tmp_path / "web", AuthenticationEnabled=False)
    with contextlib.closing(archive), tls_front(tmp_path, archive.http) as (port, certificate):
        url = f"https://127.0.0.1:{port}/dicom-web"
        send = ("records", "send", "--pacs", url, *journey["files"])
        # Whom nobody vouches for gets nothing.
        refused = run(*send, code=3).stderr
        assert "cannot reach" in refused and "certificate" in refused
        assert archive.get("/instances") == []
        run(*send, "--ca", certificate)
        instances = archive.get("/instances")
        back = {data_set_of(archive.raw(f"/instances/{each}/file")) for each in instances}
        assert back == {data_set_of(file.read_bytes()) for file in journey["files"]} and len(back) == 4
        # Twice is once.
        run(*send, "--ca", certificate)
        assert archive.get("/instances") == instances


@pytest.mark.skipif(not DICOMWEB.exists(), reason="orthanc-dicomweb is not installed")
def test_what_a_web_service_does_not_take_is_told(journey: Dict[str, Any], tmp_path: pathlib.Path) -> None:
    archive = web_archive(tmp_path / "web", AuthenticationEnabled=False)
    try:
        url = f"http://127.0.0.1:{archive.http}"
        report = journey["files"][0]
        assert "DICOMweb service?" in run("records", "send", "--pacs", f"{url}/nowhere", report, code=4).stderr
        plain = ("records", "send", "--pacs", f"{url}/dicom-web", "--user", "clinic", report)
        assert "use https://" in run(*plain, code=2).stderr
        (tmp_path / "text.dcm").write_text("no DICOM")
        text = run("records", "send", "--pacs", f"{url}/dicom-web", tmp_path / "text.dcm", code=2)
        assert "is not a file of DICOM" in text.stderr
        torn = tmp_path / "torn.dcm"
        torn.write_bytes(report.read_bytes()[:200])
        assert "did not take" in run("records", "send", "--pacs", f"{url}/dicom-web", torn, code=4).stderr
        run("records", "send", "--pacs", f"{url}/dicom-web/", report)
        assert len(archive.get("/instances")) == 1
    finally:
        archive.close()
    gone = run("records", "send", "--pacs", f"{url}/dicom-web", report, code=3)
    assert "cannot reach" in gone.stderr
