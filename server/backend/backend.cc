#include "server/backend/backend.h"

namespace lipofill::server {

void Backend::check_alive() const {
  sessions.cached_views();
  workers.queue_depth();
  calls.queue_depth();
  builds.queue_depth();
}

}  // namespace lipofill::server
