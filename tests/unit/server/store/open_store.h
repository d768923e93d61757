#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "server/store/sql_store.h"

namespace lipofill::server {

/// The real store in a file, for tests of what stands on it.
inline std::unique_ptr<Store> open_store(const std::string& path) {
  auto store = SqlStore::open(path);
  EXPECT_TRUE(store.ok()) << store.status();
  return store.ok() ? *std::move(store) : nullptr;
}

}  // namespace lipofill::server
