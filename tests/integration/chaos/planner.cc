#include "tests/integration/chaos/planner.h"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "lipofill/v1/operation_service.grpc.pb.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::testing {
namespace {

constexpr char kPlan[] = R"(
  films { name: "plane" below_layer: "skin" extent { xi_min: 0.125 xi_max: 0.875 eta_min: 0.125 eta_max: 0.875 }
    n_xi: 3 n_eta: 3 zones { name: "middle" box { xi_min: 0 xi_max: 1 eta_min: 0 eta_max: 1 } } }
  injections { zone: "middle" volume_ml: 0.05 rate_ml_per_s: 0.1 start_s: 0 }
  time { settle_skin_speed_mm_per_s: 0 })";

void pause_for(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

}  // namespace

Planner::Planner(const ChaosDaemon& daemon, const v1::ModelSpec& model, int number, uint64_t seed)
    : daemon_(daemon), model_spec_(model), id_(absl::StrCat("p", number)), random_(seed) {}

std::string Planner::present() const {
  const std::lock_guard lock(mutex_);
  return name_;
}

std::string Planner::next_request_id() {
  return absl::StrCat(id_, "-", ++requests_);
}

template <typename Method, typename Request, typename Response>
grpc::Status Planner::ask(Method method, const Request& request, Response& response) {
  return ask_until_answered<v1::SimulationService>(daemon_, method, request, response);
}

void Planner::note(const std::string& what, uint64_t step) {
  absl::StrAppend(&told_, " ", what, "@", step);
}

/// A command with a request id of its own. False when the simulation had ended before it.
template <typename Method, typename Request, typename Response>
bool Planner::command(Method method, Request request, Response& response) {
  request.set_request_id(next_request_id());
  const grpc::Status status = ask(method, request, response);
  if (status.ok()) ++ledger_.commands;
  if (status.ok()) return true;
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION) << name_ << ": " << status.error_message();
  EXPECT_FALSE(paused_) << name_ << " was acknowledged to be PAUSED: " << status.error_message();
  ended_ = true;
  return false;
}

template <typename Request>
bool Planner::steer(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, v1::Simulation*),
                    v1::Simulation& simulation) {
  Request request;
  request.set_name(name_);
  return command(method, request, simulation);
}

v1::Simulation Planner::get(const std::string& name) {
  v1::GetSimulationRequest request;
  request.set_name(name);
  v1::Simulation simulation;
  const grpc::Status status = ask(&Stub::GetSimulation, request, simulation);
  EXPECT_TRUE(status.ok()) << name << " was acknowledged: " << status.error_message();
  return simulation;
}

/// A patient and a model: the operation that builds it may die with its daemon, the model may be
/// there all the same.
void Planner::prepare() {
  v1::CreatePatientRequest patient;
  patient.set_patient_id(id_);
  patient.set_request_id(next_request_id());
  v1::Patient made;
  using Patients = v1::PatientService::Stub;
  grpc::Status status = ask_until_answered<v1::PatientService>(daemon_, &Patients::CreatePatient, patient, made);
  ASSERT_TRUE(status.ok()) << status.error_message();
  v1::BuildModelRequest build;
  build.set_parent(made.name());
  *build.mutable_spec() = model_spec_;
  build.set_request_id(next_request_id());
  while (model_.empty()) {
    v1::Operation operation;
    status = ask_until_answered<v1::PatientService>(daemon_, &Patients::BuildModel, build, operation);
    ASSERT_TRUE(status.ok()) << status.error_message();
    while (status.ok() && !operation.done()) {
      v1::WaitOperationRequest wait;
      wait.set_name(operation.name());
      status = ask_until_answered<v1::OperationService>(daemon_, &v1::OperationService::Stub::WaitOperation, wait,
                                                        operation);
    }
    v1::Model model;
    if (status.ok() && operation.response().UnpackTo(&model)) model_ = model.name();
  }
}

void Planner::run(const std::atomic<bool>& stop) {
  prepare();
  while (!stop && !::testing::Test::HasFailure()) run_one();
}

v1::SimulationSpec Planner::make_plan() {
  v1::SimulationSpec plan;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(kPlan, &plan));
  plan.set_model(model_);
  plan.mutable_time()->set_end_s(adaptive_ ? 12.0 : 4.0);
  if (adaptive_) plan.mutable_time()->set_max_step_ms(40.0);
  return plan;
}

void Planner::run_one() {
  adaptive_ = pick(2) == 0;
  ended_ = paused_ = false;
  kept_.clear();
  told_ = adaptive_ ? "adaptive" : "fixed";
  course_ = {make_plan(), {}};
  v1::CreateSimulationRequest request;
  request.set_simulation_id(absl::StrCat("s-", id_, "-", ++simulations_));
  *request.mutable_spec() = course_.plan;
  request.set_start(pick(4) > 0);
  v1::Simulation simulation;
  ASSERT_TRUE(command(&Stub::CreateSimulation, request, simulation));
  {
    const std::lock_guard lock(mutex_);
    name_ = simulation.name();
  }
  EXPECT_EQ(get(name_).state() == v1::Simulation::READY, !request.start());
  if (!request.start()) steer(&Stub::StartSimulation, simulation);
  for (int n = 2 + pick(6); n > 0 && !ended_ && !::testing::Test::HasFailure(); --n) {
    pause_for(pick(60));
    act();
  }
  end_it();
}

void Planner::act() {
  switch (pick(6)) {
    case 0:
    case 1:
      return pause_and_resume();
    case 2:
      return keep_state();
    case 3:
      return go_back();
    case 4:
      return branch();
    default:
      // Where steps grow it matters after which one an injection comes: there it comes while
      // PAUSED.
      return adaptive_ ? pause_and_resume() : inject();
  }
}

void Planner::inject() {
  v1::InjectRequest request;
  request.set_name(name_);
  v1::Injection& injection = *request.mutable_injection();
  injection.set_zone("middle");
  injection.set_volume_ml(0.001 * (1 + pick(20)));
  injection.set_rate_ml_per_s(0.1);
  v1::Simulation simulation;
  if (!command(&Stub::Inject, request, simulation)) return;
  const size_t place = static_cast<size_t>(course_.plan.injections_size()) + course_.injections.size();
  ASSERT_EQ(static_cast<size_t>(simulation.spec().injections_size()), place + 1) << name_ << ": once and only once";
  course_.injections.push_back(
      {paused_ ? simulation.summary().steps() : 0, simulation.spec().injections(static_cast<int>(place))});
  check_plan(simulation, course_);
  note("inject", simulation.summary().steps());
}

void Planner::pause_and_resume() {
  v1::Simulation paused;
  if (!steer(&Stub::PauseSimulation, paused)) return;
  paused_ = true;
  note("pause", paused.summary().steps());
  EXPECT_EQ(paused.state(), v1::Simulation::PAUSED) << name_;
  for (int n = pick(3); n > 0; --n) inject();
  pause_for(pick(60));
  // It may be catching up after a restart, but it never passes the step it was paused at.
  const v1::Simulation still = get(name_);
  EXPECT_EQ(still.state(), v1::Simulation::PAUSED) << name_ << ": " << still.reason();
  EXPECT_LE(still.summary().steps(), paused.summary().steps()) << name_;
  EXPECT_TRUE(still.has_recovery() || still.summary().steps() == paused.summary().steps())
      << name_ << ": an earlier step is marked as such";
  if (pick(3) == 0) go_back();
  v1::Simulation resumed;
  EXPECT_TRUE(steer(&Stub::ResumeSimulation, resumed)) << name_;
  paused_ = false;
  note("resume", resumed.summary().steps());
}

void Planner::keep_state() {
  v1::CreateCheckpointRequest request;
  request.set_parent(name_);
  request.set_checkpoint_id(absl::StrCat("c", requests_));
  v1::Checkpoint checkpoint;
  if (!command(&Stub::CreateCheckpoint, request, checkpoint)) return;
  kept_.push_back({checkpoint, course_.injections});
  note("keep", checkpoint.step());
}

void Planner::go_back() {
  if (kept_.empty()) return;
  const size_t chosen = static_cast<size_t>(pick(static_cast<int>(kept_.size())));
  v1::RestoreSimulationRequest request;
  request.set_checkpoint(kept_[chosen].checkpoint.name());
  v1::Simulation back;
  if (!command(&Stub::RestoreSimulation, request, back)) return;
  course_.injections = kept_[chosen].injections;
  kept_.resize(chosen + 1);  // those after it are off course
  note(absl::StrCat("restore ", kept_[chosen].checkpoint.step()), back.summary().steps());
  check_plan(back, course_);
  EXPECT_TRUE(!paused_ || back.summary().steps() == kept_[chosen].checkpoint.step()) << name_;
}

/// Another simulation from a kept state, run to its end beside this one.
void Planner::branch() {
  if (kept_.empty()) return;
  const Kept& from = kept_.back();
  v1::RestoreSimulationRequest request;
  request.set_checkpoint(from.checkpoint.name());
  request.set_as_new(true);
  request.set_start(true);
  v1::Simulation made;
  if (!command(&Stub::RestoreSimulation, request, made)) return;
  EXPECT_EQ(made.origin(), from.checkpoint.name());
  check_result(made.name(), {course_.plan, from.injections}, from.checkpoint.step() + 1);
}

void Planner::end_it() {
  v1::Simulation simulation;
  const int way = pick(8);
  if (way == 0) {
    v1::DeleteSimulationRequest request;
    request.set_name(name_);
    google::protobuf::Empty nothing;
    const grpc::Status status = ask(&Stub::DeleteSimulation, request, nothing);
    // Repeated, it may find that it was done.
    EXPECT_TRUE(status.ok() || status.error_code() == grpc::StatusCode::NOT_FOUND) << status.error_message();
    ledger_.deleted.insert(name_);
  } else if (way == 1 && !ended_ && steer(&Stub::StopSimulation, simulation)) {
    const v1::Simulation stopped = await_end(name_);
    if (lacked_memory(stopped)) return;
    EXPECT_EQ(stopped.state(), v1::Simulation::STOPPED) << name_;
    check_plan(stopped, course_);
    check_rows(name_, 1, stopped.summary().steps());
    EXPECT_EQ(stopped.summary().state_hash(), run_unbroken(model_spec_, course_, stopped.summary().steps()).state_hash)
        << name_ << ": " << told_;
    ledger_.results[name_] = stopped.summary().state_hash();
  } else {
    check_result(name_, course_, 1);
  }
}

v1::Simulation Planner::await_end(const std::string& name) {
  v1::Simulation simulation = get(name);
  const auto is_over = [&simulation] {
    const bool is_kept = simulation.reason().find("the result is not kept yet") == std::string::npos;
    return is_kept && simulation.state() >= v1::Simulation::SETTLED && simulation.state() != v1::Simulation::QUEUED;
  };
  while (!is_over() && !::testing::Test::HasFailure()) {
    pause_for(5);
    simulation = get(name);
  }
  return simulation;
}

/// One that finds no memory may fail, in words.
bool Planner::lacked_memory(const v1::Simulation& ended) {
  const bool lacked =
      ended.state() == v1::Simulation::FAILED && ended.reason().find("ran out of memory") != std::string::npos;
  ledger_.lacked_memory += lacked;
  return lacked;
}

void Planner::check_result(const std::string& name, const Course& course, uint64_t first_row) {
  const v1::Simulation ended = await_end(name);
  if (lacked_memory(ended)) return;
  EXPECT_EQ(ended.state(), v1::Simulation::FINISHED) << name << ": " << ended.reason();
  check_plan(ended, course);
  const Outcome expected = run_unbroken(model_spec_, course);
  EXPECT_EQ(ended.summary().steps(), expected.steps) << name;
  EXPECT_EQ(ended.summary().state_hash(), expected.state_hash) << name << ": " << told_;
  check_rows(name, first_row, expected.steps);
  ledger_.results[name] = ended.summary().state_hash();
}

/// Each acknowledged injection once, in order, and none besides.
void Planner::check_plan(const v1::Simulation& simulation, const Course& course) {
  const auto& injections = simulation.spec().injections();
  const int first = course.plan.injections_size();
  ASSERT_EQ(injections.size(), first + static_cast<int>(course.injections.size())) << simulation.name();
  for (size_t i = 0; i < course.injections.size(); ++i) {
    EXPECT_EQ(injections[first + static_cast<int>(i)].SerializeAsString(),
              course.injections[i].injection.SerializeAsString())
        << simulation.name();
  }
}

void Planner::check_rows(const std::string& name, uint64_t first, uint64_t last) {
  v1::GetSeriesRequest request;
  request.set_name(name);
  v1::GetSeriesResponse series;
  const grpc::Status status = ask(&Stub::GetSeries, request, series);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(static_cast<uint64_t>(series.rows_size()), last + 1 - first) << name;
  for (int i = 0; i < series.rows_size(); ++i) ASSERT_EQ(series.rows(i).step(), first + static_cast<uint64_t>(i));
}

void Planner::check_ledger() {
  for (const auto& [name, hash] : ledger_.results) EXPECT_EQ(get(name).summary().state_hash(), hash) << name;
  for (const std::string& name : ledger_.deleted) {
    v1::GetSimulationRequest request;
    request.set_name(name);
    v1::Simulation simulation;
    EXPECT_EQ(ask(&Stub::GetSimulation, request, simulation).error_code(), grpc::StatusCode::NOT_FOUND) << name;
  }
}

}  // namespace lipofill::testing
