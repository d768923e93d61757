#include "server/sessions/thread_name.h"

#include <pthread.h>

namespace lipofill::server {

void name_this_thread(const std::string& name) {
  constexpr size_t kLongest = 15;
  ::pthread_setname_np(::pthread_self(), name.substr(0, kLongest).c_str());
}

}  // namespace lipofill::server
