"""Frames: arrays over the bytes of the messages, every one of them, coded, acknowledged, and meshes
that come once.
"""

import numpy as np
import pytest

import lipofill
from conftest import make_plate
from lipofill.arrays import ArrayAssembler
from lipofill.v1 import frame_service_pb2 as pb


def piece(name="skin.displacement", shape=(2, 3), offset=0, data=None, **more):
    values = np.arange(6, dtype="<f4").tobytes() if data is None else data
    given = {"unit": "mm", "location": pb.POINT, "type": pb.FLOAT32, **more}
    return pb.ArraySlice(name=name, shape=shape, offset_bytes=offset, data=values, **given)


def owner_of(values):
    """What the memory of an array belongs to."""
    while isinstance(values, np.ndarray):
        values = values.base
    return values


@pytest.fixture(scope="module")
def run(connection):
    with connection.run(make_plate()) as run:
        run.wait()
        yield run


def every_frame(connection, **choices):
    run = connection.run(make_plate())
    with run.watch(delivery="EVERY", **choices) as frames, run:
        return list(frames)


def test_arrays_lie_over_the_bytes_of_the_message():
    data = np.arange(6, dtype="<f4").tobytes()
    message = pb.ArraySlice.FromString(piece(data=data).SerializeToString())

    class Slice:
        """The message, its bytes kept to be compared."""

        def __init__(self):
            self.kept = message.data

        def __getattr__(self, name):
            return self.kept if name == "data" else getattr(message, name)

    assembler, given = ArrayAssembler(), Slice()
    assembler.add(given)
    values = assembler.take()["skin.displacement"].values
    assert owner_of(values) is given.kept
    assert np.shares_memory(values, np.frombuffer(given.kept, np.uint8))
    assert not values.flags.writeable and values.tolist() == [[0, 1, 2], [3, 4, 5]]


def test_frames_from_the_daemon_own_no_copy(run):
    frame = run.final_frame()
    for array in [*frame.fields.values(), *frame.meshes.arrays.values()]:
        assert not array.values.flags.owndata and isinstance(owner_of(array.values), bytes), array.name


def test_an_array_in_pieces_becomes_whole():
    assembler, data = ArrayAssembler(), np.arange(6, dtype="<f4").tobytes()
    assembler.add(piece(data=data[:10]))
    assembler.add(piece(data=data[10:], offset=10))
    assert assembler.take()["skin.displacement"].values.tolist() == [[0, 1, 2], [3, 4, 5]]


@pytest.mark.parametrize(
    "pieces, complaint",
    [
        ([piece(offset=4)], "byte 4 came where byte 0 was due"),
        ([piece(shape=(1, 3))], "longer than its shape"),
        ([piece(shape=(3, 3))], "ended after 24 of 36 bytes"),
        ([piece(shape=())], "no usable shape"),
        ([piece(shape=(1 << 40, 1 << 40))], "no usable shape"),
        ([piece(type=99)], "unknown type 99"),
        ([piece(location=99)], "unknown location 99"),
        ([piece(type=pb.UINT16)], "without a usable box"),
        ([piece(type=pb.UINT16, box_min=[0, 0, 0], box_max=[1, 1, np.inf])], "without a usable box"),
        ([piece(), piece("a.b"), piece()], "came twice"),
    ],
)
def test_pieces_that_do_not_fit_are_refused(pieces, complaint):
    assembler = ArrayAssembler()
    with pytest.raises(lipofill.DataLossError, match=complaint):
        for each in pieces:
            assembler.add(each)
        assembler.take()


def test_every_frame_comes_once_and_in_order(connection):
    frames = every_frame(connection, meshes=["skin"])
    sequences = [frame.sequence for frame in frames if not frame.end]
    assert sequences == list(range(sequences[0], 30)) and sequences[0] <= 1
    assert frames[-1].end and frames[-1].sequence == 30
    assert len({frame.epoch for frame in frames}) == 1 and not any(frame.skipped_frames for frame in frames)


def test_codes_are_as_near_as_they_say(run):
    exact, coded = run.final_frame(), None
    with run.watch(compact=True) as frames:
        *_, coded = frames
    # A kept result is coded as it is asked for, too.
    checked = 0
    for name, array in coded.fields.items():
        error = np.abs(array.values.astype(float) - exact[name].astype(float)).max()
        assert error <= array.max_error, name
        checked += array.max_error > 0
        assert array.values.dtype == exact[name].dtype
    assert checked >= 3


def test_codes_come_while_it_runs(connection):
    frames = every_frame(connection, compact=True, fields=["skin.displacement"])
    assert all(list(frame) == ["skin.displacement"] for frame in frames)
    lift = frames[-1].fields["skin.displacement"]
    assert 0 < lift.max_error < 1e-3 and lift.values.dtype == np.float32 and not lift.values.flags.writeable


def test_meshes_come_once_by_their_hash(run, connection):
    first = run.final_frame(meshes=["skin"])
    second = run.final_frame(meshes=["skin"])
    assert second.meshes is first.meshes and first.meshes.topology_hash
    more = run.final_frame(meshes=["skin", "film/deep"])
    assert "film/deep.points" in more.meshes and "film/deep.points" not in first.meshes


def test_a_viewer_that_acknowledges_gets_the_newest_frame_after_a_pause(connection):
    plan = make_plate(end_s=1000)
    with connection.run(plan) as run:
        with run.watch(acknowledge=1, max_rate_hz=0, meshes=["skin"]) as frames:
            next(frames)
            step = run.get().summary.steps
            while run.get().summary.steps < step + 200:
                pass
            run.pause()
            reached = run.get().summary.steps
            newest = next(frames)
        assert newest.sequence == reached and newest.skipped_frames > 100


def test_an_interval_and_fields_are_the_viewers_choice(connection):
    frames = every_frame(connection, interval_ms=100, fields=["film/deep.pressure"])
    assert [frame.sequence for frame in frames if frame.sequence] == [10, 20, 30]
    assert frames[0].meshes.names() == ["film/deep"]


def test_a_mesh_that_is_not_there_is_refused(run):
    with pytest.raises(lipofill.InvalidArgumentError) as caught:
        next(run.watch(meshes=["bone"]))
    assert caught.value.violations[0].field.startswith("meshes")
