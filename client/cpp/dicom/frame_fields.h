#pragma once

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lipofill::client {

/// The attributes of one frame: those of its own functional groups come before those that all
/// frames share, and these before the data set's own (DICOM PS3.3, C.7.6.16).
class FrameFields {
 public:
  FrameFields(DcmItem* data_set, unsigned long frame);

  /// The numbers of an attribute, which a functional group of `group` may hold; none where it is
  /// missing, has another count, or is no finite number.
  std::optional<std::vector<double>> numbers(const DcmTagKey& group, const DcmTagKey& tag, size_t count) const;

  /// The attribute's text, values parted by '\'; empty where it is missing.
  std::string text(const DcmTagKey& group, const DcmTagKey& tag) const;

 private:
  DcmItem* data_set_;
  DcmItem* shared_ = nullptr;
  DcmItem* own_ = nullptr;
};

/// The data set's own attribute, its blanks stripped; empty where it is missing.
std::string text_of(DcmItem* data_set, const DcmTagKey& tag);

/// The data set's own whole number, or `otherwise`.
int64_t whole_number_of(DcmItem* data_set, const DcmTagKey& tag, int64_t otherwise);

}  // namespace lipofill::client
