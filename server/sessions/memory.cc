#include "server/sessions/memory.h"

#include <malloc.h>

namespace lipofill::server {

void give_memory_back() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

}  // namespace lipofill::server
