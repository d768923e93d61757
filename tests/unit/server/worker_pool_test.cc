#include "server/sessions/worker_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <string>

#include "server/sessions/task_pool.h"

namespace lipofill::server {
namespace {

/// Notes its letter at each turn until it has had enough.
class Letter : public WorkerPool::Task {
 public:
  Letter(char letter, int turns, std::string& log, std::promise<void>& done)
      : letter_(letter), turns_(turns), log_(log), done_(done) {}
  WorkerPool::Next take_turn() override {
    log_ += letter_;
    if (--turns_ > 0) return {WorkerPool::Next::kAgain, {}};
    done_.set_value();
    return {};
  }

 private:
  char letter_;
  int turns_;
  std::string& log_;
  std::promise<void>& done_;
};

/// Holds a worker until told.
class Gate : public WorkerPool::Task {
 public:
  WorkerPool::Next take_turn() override {
    open.get_future().wait();
    return {};
  }
  std::promise<void> open;
};

TEST(WorkerPool, TakesTurnsFairly) {
  std::string log;
  std::promise<void> a, b, c;
  auto gate = std::make_shared<Gate>();
  WorkerPool pool(1);
  pool.schedule(gate);
  pool.schedule(std::make_shared<Letter>('a', 3, log, a));
  pool.schedule(std::make_shared<Letter>('b', 3, log, b));
  pool.schedule(std::make_shared<Letter>('c', 1, log, c));
  gate->open.set_value();
  for (auto* done : {&a, &b, &c}) done->get_future().wait();
  EXPECT_EQ(log, "abcabab");
}

TEST(WorkerPool, WaitsUntilATaskIsDue) {
  class Later : public WorkerPool::Task {
   public:
    WorkerPool::Next take_turn() override {
      times.push_back(WorkerPool::Clock::now());
      if (times.size() == 1) return {WorkerPool::Next::kLater, times[0] + std::chrono::milliseconds(30)};
      done.set_value();
      return {};
    }
    std::vector<WorkerPool::Clock::time_point> times;
    std::promise<void> done;
  };
  auto task = std::make_shared<Later>();
  WorkerPool pool(2);
  pool.schedule(task);
  task->done.get_future().wait();
  EXPECT_GE(task->times[1] - task->times[0], std::chrono::milliseconds(30));
}

TEST(WorkerPool, StopsInTheMiddleOfWork) {
  class Endless : public WorkerPool::Task {
   public:
    WorkerPool::Next take_turn() override {
      ++turns;
      return {WorkerPool::Next::kAgain, {}};
    }
    std::atomic<int> turns = 0;
  };
  auto task = std::make_shared<Endless>();
  WorkerPool pool(3);
  pool.schedule(task);
  while (task->turns < 10) std::this_thread::yield();
  pool.stop();
  const int turns = task->turns;
  EXPECT_EQ(task->turns, turns);
  EXPECT_EQ(task.use_count(), 1);
}

TEST(TaskPool, BoundsItsQueueAndFinishesIt) {
  std::promise<void> open;
  std::promise<void> begun;
  std::atomic<int> ran = 0;
  TaskPool pool("test", 1, 2);
  ASSERT_TRUE(pool.run([&] {
    begun.set_value();
    open.get_future().wait();
  }));
  begun.get_future().wait();
  EXPECT_TRUE(pool.run([&ran] { ++ran; }));
  EXPECT_TRUE(pool.run([&ran] { ++ran; }));
  EXPECT_FALSE(pool.run([&ran] { ++ran; }));
  open.set_value();
  pool.stop();
  EXPECT_EQ(ran, 2);
  EXPECT_FALSE(pool.run([] {}));
}

}  // namespace
}  // namespace lipofill::server
