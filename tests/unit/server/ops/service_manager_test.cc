// The protocol of systemd's notifications, with a real datagram socket in systemd's place.

#include "server/ops/service_manager.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

#include "server/ops/drain_guard.h"
#include "server/ops/logging.h"
#include "tests/unit/server/ops/notify_socket.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using lipofill::testing::NotifySocket;

class ServiceManagerTest : public ::testing::Test {
 protected:
  ~ServiceManagerTest() override {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) ::unsetenv(name);
  }
  lipofill::testing::TemporaryDirectory directory_;
};

TEST_F(ServiceManagerTest, IsToldOverItsSocket) {
  NotifySocket socket(directory_.file("notify"));
  ::setenv("NOTIFY_SOCKET", socket.name().c_str(), 1);
  const ServiceManager manager;
  manager.tell_ready("serving");
  EXPECT_EQ(socket.receive(), "READY=1\nSTATUS=serving");
  manager.tell_alive();
  EXPECT_EQ(socket.receive(), "WATCHDOG=1");
  manager.tell_stopping();
  EXPECT_EQ(socket.receive(), "STOPPING=1\nSTATUS=draining");
}

TEST_F(ServiceManagerTest, IsToldOverASocketWithoutAFile) {
  NotifySocket socket("@lipofill-test-" + std::to_string(::getpid()));
  ::setenv("NOTIFY_SOCKET", socket.name().c_str(), 1);
  ServiceManager().tell_ready("serving");
  EXPECT_EQ(socket.receive(), "READY=1\nSTATUS=serving");
}

TEST_F(ServiceManagerTest, MayBeAbsentOrGone) {
  ServiceManager().tell_ready("serving");
  ::setenv("NOTIFY_SOCKET", directory_.file("gone").c_str(), 1);
  ServiceManager().tell_ready("serving");
  ::setenv("NOTIFY_SOCKET", std::string(300, 'x').c_str(), 1);
  ServiceManager().tell_ready("serving");
}

TEST_F(ServiceManagerTest, WantsASignOfLifeTwiceAsOftenAsItMust) {
  EXPECT_FALSE(ServiceManager().watchdog_period());
  ::setenv("WATCHDOG_USEC", "3000000", 1);
  EXPECT_EQ(ServiceManager().watchdog_period(), std::chrono::microseconds(1'500'000));
  ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  EXPECT_TRUE(ServiceManager().watchdog_period());
  ::setenv("WATCHDOG_PID", "1", 1);
  EXPECT_FALSE(ServiceManager().watchdog_period()) << "meant for another process";
  ::unsetenv("WATCHDOG_PID");
  ::setenv("WATCHDOG_USEC", "soon", 1);
  EXPECT_FALSE(ServiceManager().watchdog_period());
}

TEST(DrainGuard, CutsOffWhatDoesNotEndInTime) {
  EXPECT_EXIT(
      {
        set_up_logging("error", "text");
        const DrainGuard guard(0.01);
        ::pause();
      },
      ::testing::ExitedWithCode(1), "not drained within 0.01 s");
}

TEST(DrainGuard, LetsGoOfWhatDoes) {
  const DrainGuard guard(3600);
}

}  // namespace
}  // namespace lipofill::server
