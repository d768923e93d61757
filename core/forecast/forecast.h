#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/forecast/grid_error.h"
#include "core/forecast/influence.h"
#include "core/forecast/retention.h"
#include "core/forecast/sessions.h"
#include "core/forecast/statistics.h"
#include "core/forecast/uncertain_input.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::forecast {

/// A follow-up is what was measured some time after the injection: the fat that is left, or the
/// volume between the skin before and then.
struct FollowUp {
  double month = 0.0;
  bool is_skin_volume = false;
  double volume = 0.0;          ///< [m3]
  double standard_error = 0.0;  ///< [m3]
};

/// The request says what a forecast is asked; lipofill.v1.ForecastSpec in SI.
struct ForecastRequest {
  plan::SimulationSpec plan;
  int members = 500;
  std::vector<UncertainInput> inputs;
  bool only_named_inputs = false;
  RetentionSpec retention;
  std::vector<double> months = {1.0, 3.0, 6.0, 12.0};
  std::optional<FollowUp> follow_up;
  std::map<std::string, double> wanted;  ///< by zone [m3]
  double session_band = 0.0;             ///< [Pa]
  double months_between_sessions = 6.0;
  bool figures_only = false;
};

/// Kinds of figures of a shape.
enum class FigureKind { kMaxLift, kSkinVolume, kMeanPressure, kVolume };

/// A figure over the members, with what causes its spread.
struct ForecastFigure {
  FigureKind kind = FigureKind::kMaxLift;
  std::string zone;      ///< empty: of the whole face
  double nominal = 0.0;  ///< [m], [m3] or [Pa], as all of it
  Spread spread;
  std::optional<Influences> influences;  ///< none where they were not asked for
};

/// Probabilities that the pressure of a zone lies below 9 mmHg, from there to 15, to 30, above.
struct PressureBands {
  std::string zone;
  Eigen::Vector4d probability = Eigen::Vector4d::Zero();
};

/// The face after so many months.
struct ForecastTime {
  double month = 0.0;
  std::vector<ForecastFigure> figures;
  std::vector<PressureBands> bands;
  Eigen::Matrix3Xd mean_displacement;  ///< of the skin's nodes [m]; empty where figures are all that is asked
  Eigen::VectorXd lift_p05, lift_p95;  ///< length of the displacement [m]
};

/// Members that did not settle, by reason.
struct MemberFailure {
  std::string reason;
  int members = 0;
  int first = 0;
};

/// A forecast is what is known of a plan's result.
struct Forecast {
  std::vector<UncertainInput> inputs;  ///< the last is retention
  int members = 0;
  int failed = 0;
  std::vector<MemberFailure> failures;
  std::vector<ForecastTime> times;
  std::vector<std::string> causes;  ///< sentences
  Retention retention;
  Retention prior;  ///< before the follow-up
  std::vector<ZoneForecast> zones;
  std::vector<Session> sessions;
  absl::StatusOr<GridError> grid_error = absl::UnknownError("it was not estimated");
  std::vector<std::string> remarks;
  std::string content_hash;
};

/// Keeps finished parts of the work, so that it goes on where it was ended.
struct KeptParts {
  std::function<std::optional<std::string>(int part)> load;
  std::function<void(int part, const std::string& bytes)> save;
};

/// Adds what is wrong with the numbers of a request, before a model is at hand. Field violations
/// are named as in lipofill.v1.ForecastSpec.
void check_request(const ForecastRequest& request, FieldViolations& violations);

/// Finds the settled shapes of members that differ in all that is uncertain, and what they say
/// together. Deterministic: neither workers nor parts that are kept change a byte.
/// INVALID_ARGUMENT with field violations, FAILED_PRECONDITION for a plan that has to be stepped,
/// or where fewer than half of the members settle; CANCELLED.
/// Checked by tests/unit/forecast/forecast_test.cc and
/// tests/verification/forecast/coverage_test.cc.
/// @param workers   threads
/// @param progress  is told the fraction that is done and the stage; false stops the work
absl::StatusOr<Forecast> make_forecast(const std::shared_ptr<const model::FaceModel>& model,
                                       const ForecastRequest& request, int workers, const KeptParts& kept,
                                       const geometry::Progress& progress);

}  // namespace lipofill::forecast
