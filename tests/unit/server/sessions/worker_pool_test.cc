#include "server/sessions/worker_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <future>
#include <numeric>
#include <string>
#include <thread>

#include "server/sessions/task_pool.h"

namespace lipofill::server {
namespace {

using Clock = WorkerPool::Clock;

/// Takes turns of a given length until it has had enough of them, and notes what it got.
class Busy : public WorkerPool::Task {
 public:
  Busy(char letter, std::chrono::milliseconds turn, int turns, std::string& log)
      : letter_(letter), turn_(turn), turns_(turns), log_(log) {}
  WorkerPool::Next take_turn() override {
    const Clock::time_point begin = Clock::now();
    log_ += letter_;
    ++turns_taken;
    std::this_thread::sleep_for(turn_);
    const Clock::duration taken = Clock::now() - begin;
    used += taken;
    longest = std::max(longest, taken);
    if (--turns_ > 0) return {WorkerPool::Next::kAgain, {}};
    done.set_value();
    return {};
  }
  std::atomic<int> turns_taken = 0;
  Clock::duration used{};
  Clock::duration longest{};
  std::promise<void> done;

 private:
  const char letter_;
  const std::chrono::milliseconds turn_;
  int turns_;
  std::string& log_;
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

TEST(WorkerPool, GivesTheSameTimeToLongAndShortTurns) {
  std::string log;
  const auto gate = std::make_shared<Gate>();
  const auto big = std::make_shared<Busy>('B', std::chrono::milliseconds(20), 1000, log);
  const auto small = std::make_shared<Busy>('s', std::chrono::milliseconds(1), 60, log);
  WorkerPool pool(1);
  pool.schedule(gate);
  pool.schedule(big);
  pool.schedule(small);
  gate->open.set_value();
  small->done.get_future().wait();
  pool.stop();
  EXPECT_EQ(log.substr(0, 2), "Bs");
  // Whoever has had least is next: no two are further apart than a turn. Another turn may come
  // before the pool stops; half of one is for what the pool itself takes. Turn about would give
  // sixty turns.
  const auto longest = std::max(big->longest, small->longest);
  EXPECT_LE(big->used, small->used + longest * 5 / 2);
}

TEST(WorkerPool, OneThatComesLaterNeitherOwesNorIsOwed) {
  std::string log;
  const auto first = std::make_shared<Busy>('a', std::chrono::milliseconds(2), 1000, log);
  const auto second = std::make_shared<Busy>('b', std::chrono::milliseconds(2), 20, log);
  WorkerPool pool(1);
  pool.schedule(first);
  while (first->turns_taken < 20) std::this_thread::yield();
  pool.schedule(second);
  second->done.get_future().wait();
  pool.stop();
  const size_t begin = log.find('b');
  EXPECT_GE(std::count(log.begin() + static_cast<ptrdiff_t>(begin), log.end(), 'a'), 5);
}

TEST(WorkerPool, HasTheOthersWaitInAQueue) {
  std::string log;
  const auto gate = std::make_shared<Gate>();
  const auto a = std::make_shared<Busy>('a', std::chrono::milliseconds(0), 2, log);
  const auto b = std::make_shared<Busy>('b', std::chrono::milliseconds(0), 2, log);
  const auto c = std::make_shared<Busy>('c', std::chrono::milliseconds(0), 2, log);
  WorkerPool pool(2, 1);
  pool.schedule(gate);
  for (const auto& task : {a, b, c}) pool.schedule(task);
  EXPECT_EQ(pool.queue_position(*gate), 0u);
  EXPECT_EQ(pool.queue_position(*a), 1u);
  EXPECT_EQ(pool.queue_position(*c), 3u);
  EXPECT_EQ(pool.n_waiting(), 3u);
  EXPECT_TRUE(pool.withdraw(*b));
  EXPECT_FALSE(pool.withdraw(*b));
  EXPECT_EQ(pool.queue_position(*c), 2u);
  gate->open.set_value();
  c->done.get_future().wait();
  pool.stop();
  EXPECT_EQ(log, "aacc");
}

/// Tasks of a group, with turns of 2 ms, that take turns until the pool stops.
struct Crowd {
  Crowd(WorkerPool& pool, const std::string& group, int n) {
    for (int i = 0; i < n; ++i) {
      tasks.push_back(std::make_shared<Busy>('x', std::chrono::milliseconds(2), 1'000'000, logs.emplace_back()));
    }
    for (const auto& task : tasks) pool.schedule(task, group);
  }
  int turns() const {
    return std::accumulate(tasks.begin(), tasks.end(), 0, [](int n, const auto& t) { return n + t->turns_taken; });
  }
  void await(int n) const {
    while (turns() < n) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  Clock::duration used() const {
    return std::accumulate(tasks.begin(), tasks.end(), Clock::duration(),
                           [](auto sum, const auto& t) { return sum + t->used; });
  }
  std::deque<std::string> logs;  ///< each has its own: they run at the same time
  std::vector<std::shared_ptr<Busy>> tasks;
};

TEST(WorkerPool, GivesTheSameTimeToGroupsHoweverManyTheirTasks) {
  for (const int n_workers : {1, 2}) {
    WorkerPool pool(n_workers);
    const Crowd many(pool, "many", 5);
    const Crowd two(pool, "two", 2);
    two.await(100);
    pool.stop();
    // Time counts, not turns: those of a busy machine may be long.
    const double share = std::chrono::duration<double>(two.used()) / many.used();
    EXPECT_GT(share, 0.6);
    EXPECT_LT(share, 1.5);
  }
}

TEST(WorkerPool, AGroupThatComesLaterNeitherOwesNorIsOwed) {
  WorkerPool pool(1);
  const Crowd first(pool, "first", 3);
  first.await(30);
  const int before = first.turns();
  const Crowd second(pool, "second", 1);
  second.await(20);
  pool.stop();
  EXPECT_GE(first.turns() - before, 5);
}

TEST(WorkerPool, AGroupWithFewerTasksThanThreadsSavesNothingUp) {
  WorkerPool pool(3);
  const Crowd many(pool, "many", 4);
  const Crowd one(pool, "few", 1);
  one.await(40);  // `many` has had twice as much
  const int before = many.turns();
  const Crowd others(pool, "few", 4);
  others.await(20);
  pool.stop();
  EXPECT_GE(many.turns() - before, 5);
}

TEST(WorkerPool, AdmitsGroupsInTurn) {
  std::string log;
  const auto gate = std::make_shared<Gate>();
  const auto a = std::make_shared<Busy>('a', std::chrono::milliseconds(0), 1, log);
  const auto b = std::make_shared<Busy>('b', std::chrono::milliseconds(0), 1, log);
  const auto c = std::make_shared<Busy>('c', std::chrono::milliseconds(0), 1, log);
  WorkerPool pool(1, 1);
  pool.schedule(gate, "ward");
  pool.schedule(a, "ward");
  pool.schedule(b, "ward");
  pool.schedule(c, "clinic");
  EXPECT_EQ(pool.queue_position(*c), 1u);
  EXPECT_EQ(pool.queue_position(*a), 2u);
  EXPECT_EQ(pool.queue_position(*b), 3u);
  gate->open.set_value();
  b->done.get_future().wait();
  pool.stop();
  EXPECT_EQ(log, "cab");
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
