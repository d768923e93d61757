#pragma once

#include <string>

#include "client/cpp/volume/volume_reader.h"

namespace lipofill::client {

/// The values of a volume.
struct ValueRange {
  double least = 0.0;
  double most = 0.0;
  /// Otsu's threshold, which parts the values into two classes that differ most from each other:
  ///
  ///     max over t of  w0(t) w1(t) (m0(t) - m1(t))^2
  ///
  /// with w the shares and m the means of the voxels below and above t, on a histogram of 256 bins
  /// (N. Otsu, IEEE Trans. SMC 9, 1979). In a head in air it lies between air and tissue.
  double threshold = 0.0;
};

/// Two passes over the voxels. Checked by tests/unit/client/volume_kinds_test.cc.
ValueRange find_value_range(const Volume& volume);

/// Says what is wrong with an isovalue that gives no surface, what values there are, and one to
/// try.
std::string explain_no_surface(const Volume& volume, double isovalue);

}  // namespace lipofill::client
