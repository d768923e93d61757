// More connections than the daemon may have: it stays reachable, and says where it is not.

#include <httplib.h>
#include <sys/resource.h>

#include <algorithm>
#include <thread>

#include "tests/integration/security/raw_http2.h"
#include "tests/integration/security/secure_fixture.h"
#include "tests/integration/service/footprint.h"

namespace lipofill::testing {
namespace {

class DescriptorsTest : public SecureTest {
 protected:
  DescriptorsTest() : SecureTest({}) {}

  void start_with(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"--metrics-listen", "127.0.0.1:0", "--self-check-s", "0.2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    start(arguments);
  }
  int port() const { return std::stoi(daemon_->address().substr(daemon_->address().find(':') + 1)); }
  double metric(const std::string& name) const {
    const std::string log = daemon_->log();
    const size_t at = log.rfind("path /metrics (port ");
    httplib::Client http("127.0.0.1", std::stoi(log.substr(at + 20)));
    const auto answer = http.Get("/metrics");
    const std::string text = answer ? answer->body : "";
    const size_t line = text.find("\n" + name + " ");
    return line == std::string::npos ? -1.0 : std::stod(text.substr(line + name.size() + 2));
  }
  bool is_served() {
    const auto channel = grpc::CreateCustomChannel(daemon_->address(), grpc::InsecureChannelCredentials(), fresh());
    return Caller(channel, token(claims("ward", "viewer"))).call_json("PatientService/ListPatients", "{}").status.ok();
  }
  /// A channel with these shares its connection with no other.
  static grpc::ChannelArguments fresh() {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return arguments;
  }
  template <typename Condition>
  static bool comes_true(const Condition& condition) {
    for (int i = 0; i < 100; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    return false;
  }
};

TEST_F(DescriptorsTest, AreRaisedAndTold) {
  start_with({});
  rlimit limit{};
  ::prlimit(daemon_->pid(), RLIMIT_NOFILE, nullptr, &limit);
  EXPECT_EQ(limit.rlim_cur, std::min<rlim_t>(limit.rlim_max, 1 << 20));
  EXPECT_EQ(metric("process_max_fds"), static_cast<double>(limit.rlim_cur));
  EXPECT_GT(metric("process_open_fds"), 0.0);
  EXPECT_GE(metric("lipofill_connections"), 0.0);
}

TEST_F(DescriptorsTest, ConnectionsBeyondTheBoundAreTurnedAwayAndOthersServedAfterThem) {
  start_with({"--max-connections", "50"});
  std::vector<std::unique_ptr<RawHttp2>> crowd;
  for (int i = 0; i < 300; ++i) crowd.push_back(std::make_unique<RawHttp2>(port()));
  EXPECT_TRUE(comes_true([&] { return metric("lipofill_connections_full_total") >= 250.0; }));
  EXPECT_FALSE(is_served());
  EXPECT_LE(metric("lipofill_connections"), 50.0);
  crowd.clear();
  EXPECT_TRUE(comes_true([&] { return is_served(); }));
}

TEST_F(DescriptorsTest, RunningOutOfThemIsNoticedAndPasses) {
  start_with({"--max-connections", "2000"});
  const auto open = static_cast<rlim_t>(read_footprint(daemon_->pid()).sockets) + 60;
  const rlimit few = {open, open};
  rlimit before{};
  ASSERT_EQ(::prlimit(daemon_->pid(), RLIMIT_NOFILE, &few, &before), 0);
  std::vector<std::unique_ptr<RawHttp2>> crowd;
  for (int i = 0; i < 200; ++i) crowd.push_back(std::make_unique<RawHttp2>(port()));
  EXPECT_TRUE(comes_true([&] { return daemon_->log().find("health says NOT_SERVING") != std::string::npos; }));
  crowd.clear();
  EXPECT_TRUE(comes_true([&] { return is_served(); })) << "the port is not deaf";
  EXPECT_TRUE(comes_true([&] { return daemon_->log().find("can be reached again") != std::string::npos; }));
}

}  // namespace
}  // namespace lipofill::testing
