// A step in its stride allocates nothing: counted at malloc, under which everything else lies.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "tests/unit/simulation/small_case.h"

namespace {

std::atomic<long> allocations{0};
std::atomic<bool> is_counting{false};

void count() {
  if (is_counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

// glibc's own, under other names.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) {
  count();
  return __libc_malloc(size);
}
void* calloc(size_t n, size_t size) {
  count();
  return __libc_calloc(n, size);
}
void* realloc(void* old, size_t size) {
  count();
  return __libc_realloc(old, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, size_t alignment, size_t size) {
  count();
  *out = __libc_memalign(alignment, size);
  return *out == nullptr ? 12 : 0;
}
}

namespace lipofill::simulation {
namespace {

constexpr int kWarmUpSteps = 12;
constexpr int kCountedSteps = 12;

long count_allocations_of_steps(const SimulationSpec& spec, const FaceModelSpec& model_spec) {
  auto model = build_face_model(model_spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  if (!model.ok()) return -1;
  auto simulation = Simulation::create(*model, spec);
  EXPECT_TRUE(simulation.ok()) << simulation.status();
  if (!simulation.ok()) return -1;
  for (int k = 0; k < kWarmUpSteps; ++k) (*simulation)->advance_step();
  allocations = 0;
  is_counting = true;
  for (int k = 0; k < kCountedSteps; ++k) (*simulation)->advance_step();
  is_counting = false;
  EXPECT_EQ((*simulation)->phase(), Phase::kRunning) << (*simulation)->reason();
  return allocations;
}

TEST(Allocation, CountsWhatAllocates) {
  allocations = 0;
  is_counting = true;
  std::vector<double> made(1000, 1.0);
  is_counting = false;
  EXPECT_EQ(made.size(), 1000u);
  EXPECT_EQ(allocations.load(), 1);
}

TEST(Allocation, AStepOfFewCellsHasNone) {
  EXPECT_EQ(count_allocations_of_steps(make_small_plan(), make_small_model_spec()), 0);
}

TEST(Allocation, AStepOfManyCellsHasNone) {
  // Pressures by conjugate gradients.
  FaceModelSpec model = make_small_model_spec();
  model.n_xi = model.n_eta = 24;
  SimulationSpec spec = make_small_plan();
  spec.films[0].n_xi = spec.films[0].n_eta = 12;
  EXPECT_EQ(count_allocations_of_steps(spec, model), 0);
}

TEST(Allocation, AStepOfFatWithInertiaOrYieldStressHasNone) {
  SimulationSpec spec = make_small_plan();
  spec.fat_viscosity = 0.05;
  EXPECT_EQ(count_allocations_of_steps(spec, make_small_model_spec()), 0);
  spec.fat_viscosity = 10.0;
  spec.fat_yield_stress = 20.0;
  EXPECT_EQ(count_allocations_of_steps(spec, make_small_model_spec()), 0);
}

}  // namespace
}  // namespace lipofill::simulation
