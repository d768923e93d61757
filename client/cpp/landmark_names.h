#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lipofill::client {

/// The name under which the daemon knows a landmark, from how common schemes write it: the words of
/// anthropometry and their abbreviations (Farkas 1994: go, zy, ch, t or tr, ex, al, and n, prn, sn,
/// pg, me), the side of the subject as left, right, l, r before or behind, in whatever case and
/// with whatever between: "go_L", "exR", "Left Zygion", "ch.r". Nothing for other names, for a name
/// of a pair without a side ("tr" alone is the trichion), and for one of the midline with a side.
/// Checked by tests/unit/client/landmark_formats_test.cc.
std::optional<std::string> understand_landmark_name(std::string_view name);

}  // namespace lipofill::client
