#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/records/finished_plan.h"
#include "client/cpp/records/record_study.h"

namespace lipofill::client {

/// The planned fat as a binary segmentation of the series that the scan came from (PS3.3, A.51): a
/// segment a film, on the pixels of the series, in the slices that hold fat. It lies where the fat
/// comes to rest; the tissue that moved aside for it is where it was in the images.
struct FatRecord {
  std::unique_ptr<DcmDataset> record;
  double film_ml = 0.0;    ///< volume of the films
  double voxels_ml = 0.0;  ///< volume of the voxels that are labelled
  size_t frames = 0;
};

/// Makes the record. FAILED_PRECONDITION for a study without a volume or a frame of reference, and
/// where no voxel is half fat; INVALID_ARGUMENT for fat outside of the series. Checked by
/// tests/unit/client/records_test.cc.
absl::StatusOr<FatRecord> make_fat_record(const RecordStudy& study, const FinishedPlan& plan);

}  // namespace lipofill::client
