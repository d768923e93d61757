#include "server/sessions/memory_reserve.h"

#include <gtest/gtest.h>

#include <new>

namespace lipofill::server {
namespace {

TEST(MemoryReserve, WhatMayFailThrowsAndOthersTakeWhatIsKeptBack) {
  MemoryReserve::set_up();
  const std::new_handler handler = std::get_new_handler();
  EXPECT_FALSE(MemoryReserve::is_short());
  {
    const MayFail may_fail;
    EXPECT_THROW(handler(), std::bad_alloc);
  }
  EXPECT_FALSE(MemoryReserve::is_short());
  EXPECT_NO_THROW(handler()) << "to try again";
  EXPECT_TRUE(MemoryReserve::is_short());
  MemoryReserve::refill();
  EXPECT_FALSE(MemoryReserve::is_short());
  for (int block = 0; block < 4; ++block) EXPECT_NO_THROW(handler());
  EXPECT_THROW(handler(), std::bad_alloc) << "it is used up";
  MemoryReserve::refill();
  std::set_new_handler(nullptr);
}

}  // namespace
}  // namespace lipofill::server
