#pragma once

namespace lipofill::client {

/// Makes DCMTK ready, once a program: its decoders of JPEG, JPEG-LS and RLE are known, and it
/// prints nothing, for what it prints holds values of headers.
void prepare_dicom_library();

}  // namespace lipofill::client
