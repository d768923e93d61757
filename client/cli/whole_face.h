#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/cli/simulation_calls.h"
#include "client/cpp/arrays.h"

namespace lipofill::client {

/// One scan with what several simulations of its parts did to it. Displacements add up, for each
/// moves skin of its own alone; of other fields a vertex has the value of the part it belongs to.
class WholeFace {
 public:
  /// Adds the final state of a part, on the mesh "scan". DATA_LOSS for one on another scan.
  absl::Status add(FinalState state);

  const std::vector<Array>& meshes() const { return meshes_; }
  const std::vector<Array>& fields() const { return fields_; }
  double time_s() const { return time_s_; }  ///< of the part that took longest

 private:
  std::vector<Array> meshes_;
  std::vector<Array> fields_;
  double time_s_ = 0.0;
};

/// The summary of a face: sums and worst figures of its parts under the names that a single
/// simulation has, and the parts themselves.
nlohmann::ordered_json summary_of_face(const std::string& plan, const nlohmann::ordered_json& parts,
                                       const std::vector<std::string>& remarks);

}  // namespace lipofill::client
