#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lipofill/v1/model.pb.h"
#include "lipofill/v1/simulation.pb.h"

namespace lipofill::server {

/// A part of a face and the specification of its model.
struct ModelledPart {
  std::string name;
  v1::SimulationSpec plan;
  v1::ModelSpec model;
};

/// Makes one part of several, in their order: one plan, on a model around all of their zones that
/// is yet to be built. Films below the same layer become one; a zone, a probe or a ligament whose
/// name an earlier part has too is called 'name (part)', and an anatomical ligament that both have
/// is there once; the injections follow one another, and the plan lasts as long as both.
///
/// FAILED_PRECONDITION, naming the parts and what it is about: tissue, fat or time that differ; a
/// region with corners of its own; whatever is drawn on the chart of a part's own model, for the
/// larger model has another.
/// Checked by tests/unit/server/planning/face_merging_test.cc.
absl::StatusOr<ModelledPart> merge_parts(const std::vector<ModelledPart>& parts);

}  // namespace lipofill::server
