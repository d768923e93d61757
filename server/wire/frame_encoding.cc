#include "server/wire/frame_encoding.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/wire_format_lite.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/hash.h"
#include "server/wire/field_quantisation.h"

namespace lipofill::server {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays go to the wire as they lie in memory");

using google::protobuf::RepeatedPtrField;
using google::protobuf::internal::WireFormatLite;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void add_array(v1::ArraySlice& array, const std::string& name, const std::string& unit, v1::ArrayLocation location,
               v1::ArrayType type, std::initializer_list<size_t> shape, const void* data, size_t bytes) {
  array.set_name(name);
  array.set_unit(unit);
  array.set_location(location);
  array.set_type(type);
  for (const size_t n : shape) array.add_shape(n);
  array.set_data(data, bytes);
}

/// Points in single precision, which is exact to 0.06 um there, or in double precision where one of
/// them lies farther out.
void add_points(v1::ArraySlice& array, const simulation::MeshTopology& mesh) {
  constexpr double kFarthestInFloat = 1024.0;  // [mm]
  const std::string name = mesh.name + ".points";
  const size_t n = mesh.points_mm.size() / 3;
  const bool is_near = std::all_of(mesh.points_mm.begin(), mesh.points_mm.end(),
                                   [](double x) { return std::abs(x) <= kFarthestInFloat; });
  if (!is_near) {
    add_array(array, name, "mm", v1::MESH, v1::FLOAT64, {n, 3}, mesh.points_mm.data(), 3 * n * sizeof(double));
    return;
  }
  const std::vector<float> floats(mesh.points_mm.begin(), mesh.points_mm.end());
  add_array(array, name, "mm", v1::MESH, v1::FLOAT32, {n, 3}, floats.data(), 3 * n * sizeof(float));
}

/// The piece of an array from `offset` on that fits.
v1::ArraySlice cut(const v1::ArraySlice& whole, size_t offset, size_t bytes) {
  v1::ArraySlice piece;
  piece.set_name(whole.name());
  piece.set_unit(whole.unit());
  piece.set_location(whole.location());
  piece.set_type(whole.type());
  *piece.mutable_shape() = whole.shape();
  *piece.mutable_box_min() = whole.box_min();
  *piece.mutable_box_max() = whole.box_max();
  if (whole.has_max_error()) piece.set_max_error(whole.max_error());
  piece.set_offset_bytes(offset);
  piece.set_data(whole.data().data() + offset, bytes);
  return piece;
}

EncodedMessages counted(EncodedMessages encoded) {
  uint64_t bytes = 0;
  for (const std::string& message : encoded.messages) bytes += message.size();
  encoded.counted = ShownBytes(bytes);
  return encoded;
}

std::string cache_key(const Selection& selection) {
  return absl::StrCat(absl::StrJoin(selection.meshes, "\n"), "\n\n", absl::StrJoin(selection.fields, "\n"),
                      selection.quantised ? "\n\nuint16" : "");
}

}  // namespace

v1::MeshSlice to_whole_meshes(const Topology& topology, const std::vector<std::string>& meshes) {
  v1::MeshSlice whole;
  for (const simulation::MeshTopology& mesh : topology.meshes) {
    if (!contains(meshes, mesh.name)) continue;
    add_points(*whole.add_arrays(), mesh);
    const size_t kind = static_cast<size_t>(mesh.kind);
    add_array(*whole.add_arrays(), mesh.name + ".cells", "", v1::MESH, v1::UINT32, {mesh.cells.size() / kind, kind},
              mesh.cells.data(), mesh.cells.size() * sizeof(uint32_t));
  }
  whole.set_topology_hash(compute_topology_hash(whole));
  return whole;
}

void add_colours(const std::string& mesh, const std::vector<geometry::Rgb8>& colours, v1::MeshSlice& whole) {
  add_array(*whole.add_arrays(), mesh + ".colour", "", v1::POINT, v1::UINT8, {colours.size(), 3}, colours.data(),
            colours.size() * sizeof(geometry::Rgb8));
}

v1::FrameSlice to_whole_frame(const Frame& frame, const Selection& selection) {
  v1::FrameSlice whole;
  whole.set_epoch(frame.epoch);
  whole.set_sequence(frame.sequence);
  whole.set_time_s(frame.time_s);
  whole.set_end(frame.end);
  whole.set_preview(frame.preview);
  for (const simulation::FrameField& field : frame.fields) {
    const std::string name = absl::StrCat(field.mesh, ".", field.name);
    if (!selection.has_mesh(field.mesh) || !selection.has_field(name)) continue;
    const size_t components = static_cast<size_t>(field.components);
    const size_t n = field.values.size() / components;
    const auto location = field.location == simulation::FieldLocation::kPoint ? v1::POINT : v1::CELL;
    v1::ArraySlice& array = *whole.add_fields();
    add_array(array, name, field.unit, location, v1::FLOAT32, {n}, field.values.data(),
              field.values.size() * sizeof(float));
    if (components > 1) array.add_shape(components);
    if (selection.quantised) quantise(array);
  }
  return whole;
}

void check_field_type(v1::ArrayType type, FieldViolations& violations) {
  if (type == v1::ARRAY_TYPE_UNSPECIFIED || type == v1::FLOAT32 || type == v1::UINT16) return;
  violations.add("field_type", absl::StrCat("is ", v1::ArrayType_Name(type), ", fields come as FLOAT32 or UINT16"));
}

void select_meshes(const std::vector<std::string>& meshes, RepeatedPtrField<v1::ArraySlice>& arrays) {
  const auto gone = std::remove_if(arrays.begin(), arrays.end(), [&meshes](const v1::ArraySlice& array) {
    return !contains(meshes, mesh_of(array.name()));
  });
  arrays.erase(gone, arrays.end());
}

void select_fields(const Selection& selection, v1::FrameSlice& frame) {
  RepeatedPtrField<v1::ArraySlice>& fields = *frame.mutable_fields();
  const auto gone = std::remove_if(fields.begin(), fields.end(), [&selection](const v1::ArraySlice& field) {
    return !selection.has_mesh(mesh_of(field.name())) || !selection.has_field(field.name());
  });
  fields.erase(gone, fields.end());
  for (v1::ArraySlice& field : fields) {
    if (selection.quantised) quantise(field);
  }
}

std::vector<std::string> mesh_names(const v1::MeshSlice& meshes) {
  std::vector<std::string> names;
  for (const v1::ArraySlice& array : meshes.arrays()) {
    const std::string mesh = mesh_of(array.name());
    if (!contains(names, mesh)) names.push_back(mesh);
  }
  return names;
}

std::string compute_topology_hash(const v1::MeshSlice& meshes) {
  Hasher hasher;
  for (const v1::ArraySlice& array : meshes.arrays()) {
    hasher.add(array.name());
    for (const uint64_t n : array.shape()) hasher.add(n);
    hasher.add(array.data());
  }
  return hasher.hex_digest();
}

std::vector<std::vector<v1::ArraySlice>> slice_arrays(const RepeatedPtrField<v1::ArraySlice>& arrays) {
  std::vector<std::vector<v1::ArraySlice>> pieces(1);
  size_t room = kMaxSliceBytes;
  for (const v1::ArraySlice& array : arrays) {
    size_t offset = 0;
    do {
      if (room == 0) {
        pieces.emplace_back();
        room = kMaxSliceBytes;
      }
      const size_t bytes = std::min(room, array.data().size() - offset);
      pieces.back().push_back(cut(array, offset, bytes));
      offset += bytes;
      room -= bytes;
    } while (offset < array.data().size());
  }
  return pieces;
}

std::vector<v1::MeshSlice> slice_meshes(const v1::MeshSlice& whole) {
  std::vector<v1::MeshSlice> slices;
  for (std::vector<v1::ArraySlice>& piece : slice_arrays(whole.arrays())) {
    v1::MeshSlice& slice = slices.emplace_back();
    slice.set_topology_hash(whole.topology_hash());
    for (v1::ArraySlice& array : piece) slice.add_arrays()->Swap(&array);
  }
  slices.back().set_last(true);
  return slices;
}

EncodedMessages encode_meshes(const v1::MeshSlice& whole) {
  EncodedMessages encoded{whole.topology_hash(), {}, {}};
  for (v1::MeshSlice& slice : slice_meshes(whole)) {
    v1::WatchResponse response;
    response.mutable_mesh()->Swap(&slice);
    encoded.messages.push_back(response.SerializeAsString());
  }
  return counted(std::move(encoded));
}

EncodedMessages encode_frame(const v1::FrameSlice& whole) {
  EncodedMessages encoded{whole.topology_hash(), {}, {}};
  const auto pieces = slice_arrays(whole.fields());
  for (size_t i = 0; i < pieces.size(); ++i) {
    v1::FrameSlice slice;
    slice.set_epoch(whole.epoch());
    slice.set_sequence(whole.sequence());
    slice.set_time_s(whole.time_s());
    slice.set_topology_hash(whole.topology_hash());
    slice.set_end(whole.end());
    slice.set_preview(whole.preview());
    slice.set_last(i + 1 == pieces.size());
    for (const v1::ArraySlice& array : pieces[i]) *slice.add_fields() = array;
    encoded.messages.push_back(slice.SerializeAsString());
  }
  return counted(std::move(encoded));
}

// WatchResponse { frame { skipped_frames: n, <body> } }: fields of a message may come in any order.
std::string frame_header(size_t body_size, uint64_t skipped_frames) {
  std::string skipped;
  {
    google::protobuf::io::StringOutputStream sink(&skipped);
    google::protobuf::io::CodedOutputStream out(&sink);
    if (skipped_frames > 0) {
      WireFormatLite::WriteUInt64(v1::FrameSlice::kSkippedFramesFieldNumber, skipped_frames, &out);
    }
  }
  std::string header;
  {
    google::protobuf::io::StringOutputStream sink(&header);
    google::protobuf::io::CodedOutputStream out(&sink);
    WireFormatLite::WriteTag(v1::WatchResponse::kFrameFieldNumber, WireFormatLite::WIRETYPE_LENGTH_DELIMITED, &out);
    out.WriteVarint64(body_size + skipped.size());
    out.WriteString(skipped);
  }
  return header;
}

std::shared_ptr<const EncodedMessages> encode_shared(const Topology& topology, const std::vector<std::string>& meshes) {
  return topology.encodings.get(cache_key({meshes}), [&] { return encode_meshes(to_whole_meshes(topology, meshes)); });
}

std::shared_ptr<const EncodedMessages> encode_shared(const Frame& frame, const Selection& selection,
                                                     const std::string& topology_hash) {
  return frame.encodings.get(cache_key(selection), [&] {
    v1::FrameSlice whole = to_whole_frame(frame, selection);
    whole.set_topology_hash(topology_hash);
    return encode_frame(whole);
  });
}

}  // namespace lipofill::server
