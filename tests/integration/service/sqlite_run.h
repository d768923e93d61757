#pragma once

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {

/// The same model and plans on a daemon with SQLite.
class SqliteRun : public RunTest {
 public:
  v1::Simulation run(double end_s) {
    create(end_s, "x");
    return await_end("simulations/x");
  }

 private:
  void TestBody() override {}
};

}  // namespace lipofill::testing
