#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/cli/application.h"
#include "client/cli/private_daemon.h"
#include "client/cli/progress_line.h"
#include "client/cpp/plan_file.h"
#include "lipofill/v1/patient_service.pb.h"

namespace lipofill::client {

/// The options say where a plan is carried out, and on what.
struct GroundOptions {
  std::string plan;
  std::string out;        ///< a private daemon keeps its state below it
  std::string patient;    ///< is one on the daemon; where it is empty, one is made
  std::string scan;       ///< takes the place of the plan's
  std::string bone;       ///< takes the place of the plan's
  std::string landmarks;  ///< takes the place of the plan's
  std::optional<v1::ScanUnit> unit;
  bool spawn = false;
  bool several_parts = false;  ///< a plan may have them
};

/// The options --spawn to --unit of a command that carries out a plan.
/// @param help_of_spawn  what --spawn does
void add_ground_options(CLI::App& command, GroundOptions& options, const std::string& help_of_spawn);

/// The ground is what a plan needs before anything is made of it: the plan itself, a daemon, a
/// patient, the scan and the model. Each member function is one step, in their order.
class RunGround {
 public:
  RunGround(Application& application, GroundOptions options, ProgressLine& progress)
      : application_(application), options_(std::move(options)), progress_(progress) {}

  absl::Status make_folder() const;
  absl::Status read_plan();
  absl::Status reach_daemon();
  absl::Status prepare_patient();
  absl::Status send_scan();
  absl::Status build();
  /// The steps from reach_daemon() to build().
  absl::Status prepare();
  /// Builds a model of the scan that was sent.
  /// @param part  for people, of what it is; empty: of the plan
  absl::StatusOr<v1::Model> build_for(v1::ModelSpec spec, const std::string& part);
  /// Sends a surface to the patient.
  absl::StatusOr<v1::Scan> send_surface(const std::filesystem::path& file, v1::ScanUnit unit, const char* what);
  /// Deletes the patient with everything of it, where it was made here.
  void delete_patient();
  /// Ends the private daemon and deletes its state.
  void end_daemon();

  PlanFile& plan() { return plan_; }
  const PlanFile& plan() const { return plan_; }
  const Connection& connection() const { return *connection_; }
  bool is_connected() const { return connection_.has_value(); }
  const std::string& patient() const { return patient_; }
  const v1::Model& model() const { return model_; }
  bool is_private() const { return options_.spawn; }

  /// Below the folder of results, the state of a private daemon.
  static constexpr char kPrivateData[] = ".lipofilld";

 private:
  Application& application_;
  const GroundOptions options_;
  ProgressLine& progress_;
  PlanFile plan_;
  std::unique_ptr<PrivateDaemon> daemon_;
  std::optional<Connection> connection_;
  std::string patient_;
  bool made_patient_ = false;
  v1::ModelSpec model_spec_;
  v1::Model model_;
};

}  // namespace lipofill::client
