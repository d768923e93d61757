#pragma once

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmnet/scu.h>

#include "absl/status/status.h"
#include "client/cpp/records/pacs.h"

namespace lipofill::client {

/// Sets an association up; presentation contexts are the caller's.
void address_scu(const PacsAddress& pacs, DcmSCU* scu);

/// Opens the association. UNAVAILABLE or PERMISSION_DENIED with the next step.
absl::Status open_association(const PacsAddress& pacs, DcmSCU* scu);

/// Explicit and implicit little endian, which every PACS has.
OFList<OFString> plain_syntaxes();

}  // namespace lipofill::client
