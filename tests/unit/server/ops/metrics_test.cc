#include "server/ops/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <prometheus/text_serializer.h>

#include <thread>

#include "server/ops/process_figures.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

std::string text_of(const Metrics& metrics) {
  const prometheus::TextSerializer serializer;
  return serializer.prometheus::Serializer::Serialize(metrics.collect());
}

TEST(Metrics, CountStepsByPhaseWithTheRestUnderOther) {
  Metrics metrics;
  StepFigures step;
  step.wall_s = 0.02;
  step.cpu_s = 0.0115;
  step.element_cpu_s = 0.001;
  step.factor_cpu_s = 0.002;
  step.solve_cpu_s = 0.0025;
  step.film_cpu_s = 0.003;
  step.coupling_cpu_s = 0.001;
  step.film_iterations = 5;
  step.newton_iterations = 2;
  step.iterative_iterations = 7;
  step.factorisations = 1;
  step.tissue_solves = 4;
  step.fallbacks = 3;
  metrics.steps().count(step);
  metrics.steps().count(step);
  const std::string text = text_of(metrics);
  for (const char* line :
       {"lipofill_steps_total 2", "lipofill_step_wall_seconds_sum 0.04", "lipofill_step_wall_seconds_count 2",
        "lipofill_step_cpu_seconds_sum{phase=\"element\"} 0.002", "lipofill_step_cpu_seconds_sum{phase=\"film\"} 0.006",
        "lipofill_step_cpu_seconds_sum{phase=\"other\"} 0.00", "lipofill_step_cpu_seconds_count{phase=\"other\"} 2",
        "lipofill_solver_iterations_total{kind=\"film\"} 10", "lipofill_solver_iterations_total{kind=\"newton\"} 4",
        "lipofill_solver_iterations_total{kind=\"conjugate_gradient\"} 14", "lipofill_solver_factorisations_total 2",
        "lipofill_solver_solves_total 8", "lipofill_solver_fallbacks_total 6"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
}

TEST(Metrics, CountViewersCallsAndCheckpoints) {
  Metrics metrics;
  metrics.viewers().count_come();
  metrics.viewers().count_come();
  metrics.viewers().count_gone();
  metrics.viewers().count_frame_sent(0);
  metrics.viewers().count_frame_sent(5);
  const MethodMetrics method = metrics.calls().of_method("/a/B");
  method.started.Increment();
  method.sent_bytes.Increment(100);
  metrics.calls().count_handled("/a/B", "NOT_FOUND");
  metrics.simulations().count_checkpoint(0.01, 2000);
  metrics.simulations().count_failed_checkpoint();
  metrics.simulations().count_ended("SETTLED");
  const std::string text = text_of(metrics);
  for (const char* line :
       {"lipofill_viewers 1", "lipofill_frames_sent_total 2", "lipofill_frames_skipped_total 5",
        "lipofill_rpc_started_total{method=\"/a/B\"} 1", "lipofill_rpc_sent_bytes_total{method=\"/a/B\"} 100",
        "lipofill_checkpoints_total{outcome=\"written\"} 1", "lipofill_checkpoints_total{outcome=\"failed\"} 1",
        "lipofill_checkpoint_bytes_total 2000", "lipofill_simulations_ended_total{state=\"SETTLED\"} 1"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
  EXPECT_THAT(text, HasSubstr("code=\"NOT_FOUND\""));
}

TEST(Metrics, LookFiguresUpAtEachScrape) {
  Metrics metrics;
  double depth = 1.0;
  auto& gauge = metrics.add_gauge("queue", "What waits", {{"of", "test"}});
  metrics.add_refresh([&] { gauge.Set(depth); });
  EXPECT_THAT(text_of(metrics), HasSubstr("queue{of=\"test\"} 1\n"));
  depth = 8.0;
  EXPECT_THAT(text_of(metrics), HasSubstr("queue{of=\"test\"} 8\n"));
}

TEST(Metrics, KnowTheirProcess) {
  std::thread([] {}).join();  // a sanitizer starts a thread of its own with the first one
  const ProcessFigures before = read_process_figures();
  EXPECT_GT(before.resident_bytes, 1e6);
  EXPECT_GT(before.open_files, 2.0);
  bool stop = false;
  std::mutex mutex;
  mutex.lock();
  std::thread other([&] {
    const std::lock_guard lock(mutex);
    stop = true;
  });
  EXPECT_EQ(read_process_figures().threads, before.threads + 1.0);
  mutex.unlock();
  other.join();
  EXPECT_TRUE(stop);
  Metrics metrics;
  add_process_metrics(metrics);
  EXPECT_THAT(text_of(metrics), HasSubstr("process_resident_memory_bytes"));
  EXPECT_THAT(text_of(metrics), HasSubstr("lipofill_build_info{version=\""));
}

}  // namespace
}  // namespace lipofill::server
