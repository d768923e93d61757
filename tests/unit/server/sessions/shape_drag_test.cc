// Drags of shapes: the newest request takes the place of the one that waits, each is answered once,
// and drags are bounded, forgotten and closed.

#include "server/sessions/shape_drag.h"

#include <gmock/gmock.h>

#include <future>
#include <thread>
#include <vector>

#include "server/sessions/shape_desk.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::server {
namespace {

constexpr double kMillilitre = 1e-6;

/// What one request was answered with.
struct Answer {
  absl::Status status;
  double volume = 0.0;  ///< of the fat that went in [m3]
  bool is_from_rest = false;
  double preparing_s = 0.0;
  uint64_t superseded = 0;
};

class Asked {
 public:
  explicit Asked(double volume, bool from_last = true) {
    request.plan = "small";
    request.make = [] {
      plan::SimulationSpec spec = simulation::make_small_plan();
      return simulation::TrialShape::create(simulation::make_small_model(), spec);
    };
    request.volumes.injections = {{0, volume}};
    request.from_last = from_last;
    request.reply = [answer = answer_](const absl::Status& status, const FoundTrial* found) {
      Answer told{status};
      if (found != nullptr) {
        told.volume = found->shape.shape().report().injected;
        told.is_from_rest = found->shape.is_from_rest();
        told.preparing_s = found->preparing_s;
        told.superseded = found->superseded;
      }
      answer->set_value(told);
    };
  }
  Answer wait() { return answer_->get_future().get(); }

  ShapeRequest request;

 private:
  std::shared_ptr<std::promise<Answer>> answer_ = std::make_shared<std::promise<Answer>>();
};

/// Holds the only worker until told.
class Gate : public WorkerPool::Task {
 public:
  WorkerPool::Next take_turn() override {
    begun.set_value();
    open.get_future().wait();
    return {};
  }
  std::promise<void> begun, open;
};

class ShapeDragTest : public ::testing::Test {
 protected:
  Answer ask(const std::string& drag, Asked asked, const std::string& caller = "anna") {
    desk_.ask("clinic", caller, drag, asked.request);
    return asked.wait();
  }

  SessionManager sessions_{{.simulations = 6}};
  WorkerPool workers_{1, 1};
  ShapeDesk desk_{workers_, sessions_};
};

TEST_F(ShapeDragTest, GoesOnFromTheLastShapeUnlessToldOtherwise) {
  const Answer first = ask("d", Asked(0.3 * kMillilitre));
  ASSERT_TRUE(first.status.ok()) << first.status;
  EXPECT_NEAR(first.volume, 0.3 * kMillilitre, 1e-18);
  EXPECT_TRUE(first.is_from_rest) << "there was no last shape";
  EXPECT_GT(first.preparing_s, 0.0);
  const Answer second = ask("d", Asked(0.32 * kMillilitre));
  EXPECT_FALSE(second.is_from_rest);
  EXPECT_LT(second.preparing_s, 0.1 * first.preparing_s) << "the equations are at hand";
  EXPECT_TRUE(ask("d", Asked(0.32 * kMillilitre, false)).is_from_rest);
  EXPECT_EQ(desk_.n_drags(), 1u);
  EXPECT_TRUE(ask("", Asked(0.3 * kMillilitre)).is_from_rest) << "it is alone";
  EXPECT_EQ(desk_.n_drags(), 1u);
}

TEST_F(ShapeDragTest, TheNewestTakesThePlaceOfTheOneThatWaits) {
  const auto gate = std::make_shared<Gate>();
  workers_.schedule(gate, "other");
  gate->begun.get_future().wait();
  Asked first(0.1 * kMillilitre), second(0.2 * kMillilitre), third(0.3 * kMillilitre);
  for (Asked* asked : {&first, &second, &third}) desk_.ask("clinic", "anna", "d", asked->request);
  EXPECT_TRUE(absl::IsAborted(first.wait().status)) << "at once, not when a worker is free";
  EXPECT_TRUE(absl::IsAborted(second.wait().status));
  gate->open.set_value();
  const Answer newest = third.wait();
  ASSERT_TRUE(newest.status.ok()) << newest.status;
  EXPECT_NEAR(newest.volume, 0.3 * kMillilitre, 1e-18);
  EXPECT_EQ(newest.superseded, 2u);
}

TEST_F(ShapeDragTest, DoesNotWaitForSimulationsToEnd) {
  std::atomic<bool> stop = false;
  struct Endless : WorkerPool::Task {
    explicit Endless(std::atomic<bool>& until) : stop(until) {}
    WorkerPool::Next take_turn() override {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (stop) return {};
      return {WorkerPool::Next::kAgain, {}};
    }
    std::atomic<bool>& stop;
  };
  workers_.schedule(std::make_shared<Endless>(stop), "other");  // all that may run at once
  EXPECT_TRUE(ask("d", Asked(0.3 * kMillilitre)).status.ok());
  stop = true;
}

TEST_F(ShapeDragTest, ACallersFifthDragTakesThePlaceOfTheOneThatRestedLongest) {
  for (const char* drag : {"a", "b", "c", "d"}) ASSERT_TRUE(ask(drag, Asked(0.3 * kMillilitre)).status.ok());
  ASSERT_TRUE(ask("a", Asked(0.31 * kMillilitre)).status.ok());
  ASSERT_TRUE(ask("e", Asked(0.3 * kMillilitre)).status.ok());
  EXPECT_EQ(desk_.n_drags(), 4u);
  EXPECT_FALSE(ask("a", Asked(0.32 * kMillilitre)).is_from_rest) << "it was used since";
  ASSERT_TRUE(ask("a", Asked(0.3 * kMillilitre), "bert").status.ok()) << "of another caller";
  EXPECT_EQ(desk_.n_drags(), 5u);
  ASSERT_TRUE(ask("b", Asked(0.3 * kMillilitre), "bert").status.ok());
  const Answer refused = ask("c", Asked(0.3 * kMillilitre), "bert");
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status)) << "six are all that fit: " << refused.status;
}

TEST_F(ShapeDragTest, ACallerWaitsForSomeShapesWithoutADragAndOthersForTheirs) {
  SessionManager many({.simulations = 20});
  WorkerPool workers(1, 1);
  ShapeDesk desk(workers, many);
  const auto gate = std::make_shared<Gate>();
  workers.schedule(gate, "other");
  gate->begun.get_future().wait();
  std::vector<Asked> waiting;
  for (size_t k = 0; k < ShapeDesk::kMostLone; ++k) {
    desk.ask("clinic", "anna", "", waiting.emplace_back(0.3 * kMillilitre).request);
  }
  Asked further(0.3 * kMillilitre), of_another(0.3 * kMillilitre);
  desk.ask("clinic", "anna", "", further.request);
  const absl::Status refused = further.wait().status;
  EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
  desk.ask("clinic", "bert", "", of_another.request);
  gate->open.set_value();
  for (Asked& asked : waiting) EXPECT_TRUE(asked.wait().status.ok());
  EXPECT_TRUE(of_another.wait().status.ok());
  Asked later(0.3 * kMillilitre);
  desk.ask("clinic", "anna", "", later.request);
  EXPECT_TRUE(later.wait().status.ok()) << "those that were answered count no more";
}

TEST_F(ShapeDragTest, RestingDragsGiveTheirRoomBack) {
  ASSERT_TRUE(ask("d", Asked(0.3 * kMillilitre)).status.ok());
  EXPECT_GT(sessions_.memory_bytes(), 0u);
  desk_.drop_idle(std::chrono::hours(1));
  EXPECT_EQ(desk_.n_drags(), 1u);
  desk_.drop_idle(std::chrono::seconds(0));
  EXPECT_EQ(desk_.n_drags(), 0u);
  while (sessions_.memory_bytes() > 0) std::this_thread::yield();  // its last turn may not have ended
}

TEST_F(ShapeDragTest, WhatCannotBeFoundIsTheAnswerAndTheDragGoesOn) {
  ASSERT_TRUE(ask("d", Asked(0.3 * kMillilitre)).status.ok());
  EXPECT_TRUE(absl::IsInvalidArgument(ask("d", Asked(1.0)).status));
  Asked unwanted(0.3 * kMillilitre);
  unwanted.request.unwanted = [] { return true; };
  EXPECT_TRUE(absl::IsCancelled(ask("d", unwanted).status));
  Asked thrown(0.3 * kMillilitre);
  thrown.request.plan = "another";
  thrown.request.make = []() -> absl::StatusOr<std::unique_ptr<simulation::TrialShape>> { throw std::bad_alloc(); };
  EXPECT_TRUE(absl::IsResourceExhausted(ask("d", thrown).status));
  EXPECT_TRUE(ask("d", Asked(0.31 * kMillilitre)).status.ok());
}

TEST_F(ShapeDragTest, TheEndOfTheDaemonAnswersWhatWaits) {
  const auto gate = std::make_shared<Gate>();
  workers_.schedule(gate, "other");
  gate->begun.get_future().wait();
  Asked waiting(0.3 * kMillilitre);
  desk_.ask("clinic", "anna", "d", waiting.request);
  desk_.close();
  std::thread stop([this] { workers_.stop(); });
  gate->open.set_value();
  stop.join();
  const absl::Status status = waiting.wait().status;
  EXPECT_TRUE(absl::IsUnavailable(status) || status.ok()) << status;
  EXPECT_TRUE(absl::IsUnavailable(ask("d", Asked(0.3 * kMillilitre)).status));
}

}  // namespace
}  // namespace lipofill::server
