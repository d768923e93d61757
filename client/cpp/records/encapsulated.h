#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "client/cpp/records/finished_plan.h"
#include "client/cpp/records/record_study.h"

namespace lipofill::client {

/// A PDF in DICOM (PS3.3, A.45.1), byte for byte. INVALID_ARGUMENT for what does not begin as a
/// PDF. Checked by tests/unit/client/records_test.cc.
absl::StatusOr<std::unique_ptr<DcmDataset>> make_report_record(const RecordStudy& study, const FinishedPlan& plan,
                                                               const std::string& pdf);

/// The planned skin as an STL in DICOM (PS3.3, A.85.1), in millimetres and in the frame of the
/// scan. Checked by tests/unit/client/records_test.cc.
std::unique_ptr<DcmDataset> make_skin_record(const RecordStudy& study, const FinishedPlan& plan);

/// A surface as a binary STL, polygons as fans of triangles; the same surface gives the same bytes.
std::string stl_bytes(vtkPolyData* surface);

}  // namespace lipofill::client
