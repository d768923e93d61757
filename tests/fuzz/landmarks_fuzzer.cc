// A landmarks file in every format there is, and where it goes in a plan.

#include <cmath>

#include "client/cpp/landmarks_file.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  for (const char* name : {"landmarks.json", "landmarks.fcsv", "landmarks.pp", "landmarks.csv"}) {
    const auto file = lipofill::fuzz::write_scratch_file(name, lipofill::fuzz::as_text(data, size));
    const auto landmarks = lipofill::client::load_landmarks(file.string(), lipofill::v1::MILLIMETRE);
    if (!landmarks.ok()) continue;
    for (const auto& [landmark, point] : landmarks->points_mm) {
      for (const double coordinate : point) lipofill::fuzz::require(std::isfinite(coordinate), "landmarks are finite");
    }
    lipofill::v1::ScanRegion region;
    lipofill::client::set_landmarks(*landmarks, &region);
    (void)lipofill::client::up_of(region);
  }
  return 0;
}
