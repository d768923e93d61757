#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "client/cpp/connection.h"

namespace lipofill::client {

/// Reads all pages of a list call into one response. `items` gives the repeated field of a
/// response.
template <typename Service, typename Request, typename Response, typename Items>
absl::StatusOr<Response> list_all(const Connection& connection,
                                  grpc::Status (Service::Stub::*method)(grpc::ClientContext*, const Request&,
                                                                        Response*),
                                  Request request, const Items& items) {
  constexpr int kPageSize = 1000;
  request.set_page_size(kPageSize);
  Response all;
  do {
    auto page = connection.call<Service>(method, request);
    if (!page.ok()) return page.status();
    items(all)->MergeFrom(*items(*page));
    if constexpr (requires { page->unreachable(); }) all.mutable_unreachable()->MergeFrom(page->unreachable());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return all;
}

/// A line for each name of a list that is damaged and cannot be shown.
template <typename Response>
std::string unreachable_lines(const Response& response) {
  std::string text;
  for (const std::string& name : response.unreachable()) text += name + "  damaged, cannot be shown\n";
  return text;
}

/// Returns "collection/id" when given either that or the id alone.
inline std::string full_name(const std::string& collection, const std::string& name) {
  return name.find('/') == std::string::npos ? collection + "/" + name : name;
}

}  // namespace lipofill::client
