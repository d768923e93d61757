#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/field_violations.h"
#include "core/geometry/surface_reader.h"
#include "lipofill/v1/frame_service.pb.h"
#include "server/sessions/frame.h"
#include "server/sessions/selection.h"

namespace lipofill::server {

/// Bytes of arrays in one message of a stream.
constexpr size_t kMaxSliceBytes = size_t{1} << 20;

/// Whole arrays, as they are kept for simulations that have ended.
v1::MeshSlice to_whole_meshes(const Topology& topology, const std::vector<std::string>& meshes);
/// Adds "<mesh>.colour": red, green and blue at each point, as screens show them. They are no part
/// of the topology and leave its hash.
void add_colours(const std::string& mesh, const std::vector<geometry::Rgb8>& colours, v1::MeshSlice& whole);
v1::FrameSlice to_whole_frame(const Frame& frame, const Selection& selection);
/// Leaves of meshes and frames that were kept only what is selected.
void select_meshes(const std::vector<std::string>& meshes, google::protobuf::RepeatedPtrField<v1::ArraySlice>& arrays);
void select_fields(const Selection& selection, v1::FrameSlice& frame);

/// A violation of "field_type" for a type in which fields do not come.
void check_field_type(v1::ArrayType type, FieldViolations& violations);

/// Names of the meshes whose points are there.
std::vector<std::string> mesh_names(const v1::MeshSlice& meshes);

/// SHA-256 over names, shapes and bytes of the arrays.
std::string compute_topology_hash(const v1::MeshSlice& meshes);

/// The arrays in pieces of at most kMaxSliceBytes together, in order. There is at least one piece.
std::vector<std::vector<v1::ArraySlice>> slice_arrays(const google::protobuf::RepeatedPtrField<v1::ArraySlice>& arrays);

/// Slices ready to be sent by DownloadModelMesh.
std::vector<v1::MeshSlice> slice_meshes(const v1::MeshSlice& whole);

/// Serialised WatchResponses that carry the meshes.
EncodedMessages encode_meshes(const v1::MeshSlice& whole);
/// Bodies of FrameSlices, without skipped_frames: that is the one thing in which viewers differ.
/// See frame_header().
EncodedMessages encode_frame(const v1::FrameSlice& whole);
/// Makes the header that turns a body of encode_frame() into a serialised WatchResponse.
std::string frame_header(size_t body_size, uint64_t skipped_frames);

/// The same from a session, each made once and shared by all viewers of the same selection.
std::shared_ptr<const EncodedMessages> encode_shared(const Topology& topology, const std::vector<std::string>& meshes);
std::shared_ptr<const EncodedMessages> encode_shared(const Frame& frame, const Selection& selection,
                                                     const std::string& topology_hash);

}  // namespace lipofill::server
