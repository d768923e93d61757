#pragma once

#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "lipofill/v1/model.pb.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"
#include "tests/integration/chaos/chaos_daemon.h"
#include "tests/integration/chaos/reference.h"

namespace lipofill::testing {

/// What a planner was told, and what must be so for good.
struct Ledger {
  std::map<std::string, std::string> results;  ///< simulation that has ended: its state hash
  std::set<std::string> deleted;
  int commands = 0;
  int lacked_memory = 0;  ///< simulations that failed for want of it
};

/// A client that creates simulations, injects, pauses, resumes, keeps and restores their states,
/// stops and deletes them, repeats what was not answered with the same request_id, and checks after
/// each answer that all it was told before still holds. In the end every simulation must have the
/// hash of an unbroken run of what was acknowledged.
class Planner {
 public:
  Planner(const ChaosDaemon& daemon, const v1::ModelSpec& model, int number, uint64_t seed);

  /// One simulation after the other until `stop`.
  void run(const std::atomic<bool>& stop);
  /// Once nothing is killed any more: all that was told still holds.
  void check_ledger();
  const Ledger& ledger() const { return ledger_; }
  /// The simulation it is at.
  std::string present() const;

 private:
  using Stub = v1::SimulationService::Stub;
  struct Kept {
    v1::Checkpoint checkpoint;
    std::vector<TakenInjection> injections;
  };

  void prepare();
  void note(const std::string& what, uint64_t step);
  void run_one();
  void act();
  void inject();
  void pause_and_resume();
  void keep_state();
  void go_back();
  void branch();
  void end_it();
  bool lacked_memory(const v1::Simulation& ended);
  void check_result(const std::string& name, const Course& course, uint64_t first_row);
  void check_rows(const std::string& name, uint64_t first, uint64_t last);
  void check_plan(const v1::Simulation& simulation, const Course& course);

  template <typename Method, typename Request, typename Response>
  grpc::Status ask(Method method, const Request& request, Response& response);
  template <typename Method, typename Request, typename Response>
  bool command(Method method, Request request, Response& response);
  template <typename Request>
  bool steer(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, v1::Simulation*),
             v1::Simulation& simulation);
  v1::Simulation get(const std::string& name);
  v1::Simulation await_end(const std::string& name);
  v1::SimulationSpec make_plan();
  std::string next_request_id();
  int pick(int n) { return static_cast<int>(random_() % static_cast<uint64_t>(n)); }

  const ChaosDaemon& daemon_;
  const v1::ModelSpec model_spec_;
  const std::string id_;
  std::mt19937_64 random_;
  std::string model_;
  int requests_ = 0;
  int simulations_ = 0;

  mutable std::mutex mutex_;
  std::string name_;  ///< names the simulation at hand
  bool adaptive_ = false;
  bool ended_ = false;
  bool paused_ = false;
  std::string told_;  ///< what it was answered, in order
  Course course_;
  std::vector<Kept> kept_;
  Ledger ledger_;
};

}  // namespace lipofill::testing
