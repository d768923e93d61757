#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/escaping.h"
#include "server/store/records.h"
#include "server/wire/names.h"

namespace lipofill::server {

/// Names what a list cannot show because it is damaged; the name itself may be what rotted.
template <typename Response>
void add_unreachable(const std::string& name, Response& response) {
  response.add_unreachable(absl::CHexEscape(name));
}

/// One more than the page holds tells whether there is a next one.
inline Page one_more(const PageRequest& page) {
  return {page.after, page.size + 1};
}

/// Hands the records of a page to `add`; returns the token of the next page, empty after the last.
template <typename Record, typename Add>
std::string fill_page(const std::string& collection, const PageRequest& page, const std::vector<Record>& records,
                      Add&& add) {
  const size_t n = std::min(records.size(), static_cast<size_t>(page.size));
  for (size_t i = 0; i < n; ++i) add(records[i]);
  return records.size() > n ? make_page_token(collection, records[n - 1].id) : std::string();
}

}  // namespace lipofill::server
