// A library to load before others: the clock of the wall is as many seconds ahead as a file says,
// LIPOFILL_TEST_CLOCK. Without the file it is right. The steady clock goes on as it is.

#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace {

long read_seconds() {
  const char* path = std::getenv("LIPOFILL_TEST_CLOCK");
  std::FILE* file = path != nullptr ? std::fopen(path, "re") : nullptr;
  if (file == nullptr) return 0;
  long seconds = 0;
  const int read = std::fscanf(file, "%ld", &seconds);
  std::fclose(file);
  return read == 1 ? seconds : 0;
}

/// The file is read once in a while: the clock is asked all the time.
long seconds_ahead() {
  static std::atomic<long> seconds = 0;
  static std::atomic<long> asked = 0;
  if (asked++ % 64 == 0) seconds = read_seconds();
  return seconds;
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) {
  const int result = static_cast<int>(::syscall(SYS_clock_gettime, clock, time));
  if (result == 0 && clock == CLOCK_REALTIME) time->tv_sec += seconds_ahead();
  return result;
}
