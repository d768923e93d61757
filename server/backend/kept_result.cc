#include "server/backend/kept_result.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/hash.h"
#include "server/sessions/shown_bytes.h"
#include "server/store/record_names.h"

namespace lipofill::server {
namespace {

/// Makes the key from the content: a simulation of the same name may have been deleted and run
/// anew.
std::string make_key(const SimulationResult& result, Selection selection) {
  sort_out(selection.meshes);
  sort_out(selection.fields);
  Hasher hasher;
  for (const std::string& message : {result.meshes_message, result.frame_message}) {
    hasher.add(message.size());
    hasher.add(message);
  }
  return absl::StrCat(hasher.hex_digest(), "\n", absl::StrJoin(selection.meshes, "\n"), "\n\n",
                      absl::StrJoin(selection.fields, "\n"), selection.quantised ? "\n\nuint16" : "");
}

/// Returns the selection asked for; checks every name in it against those there are.
absl::StatusOr<Selection> choose(const v1::MeshSlice& meshes, const v1::FrameSlice& frame,
                                 const ViewerOptions& options) {
  Topology known;
  for (const std::string& name : mesh_names(meshes)) known.meshes.push_back({name, {}, {}, 3});
  Viewer viewer(options, [] {});
  if (const absl::Status chosen = viewer.choose_meshes(known); !chosen.ok()) return chosen;
  std::vector<std::string> fields;
  for (const v1::ArraySlice& field : frame.fields()) fields.push_back(field.name());
  if (const absl::Status checked = viewer.check_fields(fields); !checked.ok()) return checked;
  return viewer.selection();
}

using Encoded = absl::StatusOr<std::shared_ptr<const KeptMessages>>;

Encoded encode(const SimulationResult& result, const std::string& simulation, const ViewerOptions& options) {
  v1::MeshSlice meshes;
  v1::FrameSlice frame;
  if (!meshes.ParseFromString(result.meshes_message) || !frame.ParseFromString(result.frame_message)) {
    return absl::DataLossError(absl::StrCat("the result of ", simulation_name(simulation), " cannot be read"));
  }
  const auto selection = choose(meshes, frame, options);
  if (!selection.ok()) return selection.status();
  select_meshes(selection->meshes, *meshes.mutable_arrays());
  select_fields(*selection, frame);
  meshes.set_topology_hash(compute_topology_hash(meshes));
  frame.set_topology_hash(meshes.topology_hash());
  return std::make_shared<const KeptMessages>(KeptMessages{encode_meshes(meshes), encode_frame(frame)});
}

}  // namespace

absl::StatusOr<std::shared_ptr<const KeptMessages>> KeptResults::show(const std::string& simulation,
                                                                      const ViewerOptions& options) {
  const auto result = store_.get_result(simulation);
  if (!result.ok()) return result.status();
  return shown_.get(make_key(*result, options.selection), [&]() -> Encoded {
    if (shown_bytes() > options.max_shown_bytes) return too_many_shown(options.max_shown_bytes);
    return encode(*result, simulation, options);
  });
}

}  // namespace lipofill::server
