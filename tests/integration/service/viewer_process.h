#pragma once

#include <sys/types.h>

#include <string>

namespace lipofill::testing {

/// `lipofill watch` in a process of its own, to be stopped or killed at will.
class ViewerProcess {
 public:
  /// Its output goes to the file.
  ViewerProcess(const std::string& server, const std::string& simulation, bool every, std::string output);
  /// Kills it.
  ~ViewerProcess();
  ViewerProcess(const ViewerProcess&) = delete;
  ViewerProcess& operator=(const ViewerProcess&) = delete;

  void signal(int number) const;
  /// Until it has shown its first frame; false when it has not within a minute.
  bool await_frame() const;

 private:
  const std::string output_;
  pid_t process_ = -1;
};

}  // namespace lipofill::testing
