#pragma once

#include <string>
#include <vector>

#include "core/geometry/surface_distance.h"
#include "core/geometry/surface_reader.h"
#include "core/model/face_model.h"
#include "lipofill/v1/patient_service.pb.h"
#include "lipofill/v1/simulation.pb.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/sessions/session.h"

namespace lipofill::server {

/// Results of the core, in the units of the wire schema. Checked by
/// tests/unit/server/wire/report_conversion_test.cc.
v1::ModelReport to_model_report(const model::FaceModel& model);
/// A model's specification with the sizes that were chosen where it left them out, so that it gives
/// the same model for ever.
v1::ModelSpec with_chosen_sizes(v1::ModelSpec spec, const model::FaceModel& model);
v1::ScanReport to_scan_report(const geometry::SurfaceMesh& mesh, const geometry::SurfaceCheck& check);
v1::Summary to_summary(const SessionView& view);
v1::SeriesRow to_series_row(const SeriesEntry& entry);
v1::ComputingCost to_computing_cost(const mechanics::CostSum& sum);
v1::DistanceStatistics to_distance_statistics(const geometry::DistanceStatistics& statistics);
v1::Simulation::State to_state(SimulationState state);

}  // namespace lipofill::server
