#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "client/cli/plan_work.h"
#include "client/cli/thickness_sheet.h"
#include "client/cpp/dicom/dicom_volume.h"
#include "client/cpp/frame_watcher.h"
#include "client/cpp/volume/tissue_thickness.h"

namespace lipofill::client {

struct ThicknessOptions : PlanWorkOptions {
  std::string volume;
  std::string metal;                ///< a CT that shows metal, for a label map that does not
  std::vector<std::string> labels;  ///< "bone=4"
  DicomReading dicom;
  ThicknessMeasuring measuring;
};

/// Thickness of the layers of a plan, measured in a volume under each node of its skin, from a plan
/// file to a plan file. Layers of which the volume shows nothing stay as they are. Checked by
/// tests/python/test_thickness.py.
class ThicknessRun : public PlanWork {
 public:
  ThicknessRun(Application& application, ThicknessOptions options);

 private:
  absl::Status check_input() override;
  absl::Status work() override;
  absl::Status write_results() const override;
  std::string json() const override;
  std::string text() const override;
  std::string option_of(const std::string& field) const override { return field; }

  absl::Status find_labels();
  absl::Status read_metal();
  absl::Status measure(const Meshes& meshes);
  void take_layer(int layer, const Boundary& end, Eigen::VectorXd* above);
  Eigen::VectorXd default_thickness(int layer) const;

  const ThicknessOptions options_;
  Volume volume_;
  TissueLabels labels_;
  Eigen::Matrix3Xd metal_;
  SkinNodes skin_;
  Eigen::Matrix3Xd nodes_;  ///< of all levels [mm]
  v1::ModelSpec spec_;
  v1::Model model_;
  Meshes meshes_;
  ThicknessSheet sheet_;
};

}  // namespace lipofill::client
