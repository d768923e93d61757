// Bytes that claim to be the state of a simulation: taken, they must be a state that can go on;
// refused, the simulation is as it was.

#include "core/simulation/simulation.h"
#include "tests/fuzz/target.h"

namespace {

using namespace lipofill;

std::unique_ptr<simulation::Simulation> make_simulation() {
  model::FaceModelSpec model;
  model.region = geometry::SquareSpec{0.016, 0.016};
  model.n_xi = model.n_eta = 4;
  model.layers = {{"skin", {geometry::ScalarField::constant(2e-3), 1}, {1e5, 0.45, 1100.0}},
                  {"muscle", {geometry::ScalarField::constant(8e-3), 1}, {2e5, 0.45, 1050.0}}};
  plan::SimulationSpec spec;
  plan::FilmSpec film;
  film.name = "film";
  film.below_layer = "skin";
  film.n_xi = film.n_eta = 2;
  film.zones = {{"all", geometry::ChartBox{}}};
  spec.films = {film};
  spec.injections = {{"all", 0.02e-6, 1e-7, std::nullopt, geometry::ChartPoint{0.55, 0.45}}};
  return *simulation::Simulation::create(*model::build_face_model(model, nullptr), spec);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::unique_ptr<simulation::Simulation> simulation = make_simulation();
  static const std::string start = simulation->snapshot();
  const std::string_view bytes = fuzz::as_text(data, size);
  if (!simulation->restore(bytes).ok()) {
    fuzz::require(simulation->snapshot() == start, "what is refused changes nothing");
    return 0;
  }
  simulation->advance_step();
  fuzz::require(simulation->restore(start).ok(), "the state it had is taken again");
  return 0;
}
