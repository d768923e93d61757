#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "core/model/face_model.h"
#include "core/plan/film_layout.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::plan {

/// An injection with the cells of the film that it goes into.
struct PlacedInjection {
  int film = 0;
  std::vector<int> cells;
  std::vector<double> shares;                                     ///< sum 1
  double volume = 0.0;                                            ///< [m3]
  double rate = 0.0;                                              ///< [m3/s] > 0
  double start = 0.0;                                             ///< [s]
  double delivered = 0.0;                                         ///< [m3]
  double end() const { return start + std::abs(volume) / rate; }  ///< [s]
};

/// The volumes injected into each cell over time.
class InjectionSchedule {
 public:
  /// Places an injection that may be added. Field violations are named as in lipofill.v1.Injection.
  /// Without a start it begins at `now` or when the last one ends.
  absl::StatusOr<PlacedInjection> place(const model::FaceModel& model, const std::vector<FilmLayout>& films,
                                        const InjectionSpec& spec, double now) const;
  void add(PlacedInjection injection);

  /// Volume that each cell of each film receives between `time` and `time + dt`, and notes it as
  /// delivered [m3]. No more is taken out of a cell than nearly all that it holds; the rest stays
  /// due. A film between rigid walls stays full.
  /// @param held  volume of fat in a cell of a film now [m3]
  void deliver(const std::vector<FilmLayout>& films, absl::FunctionRef<double(int film, int cell)> held, double time,
               double dt, std::vector<Eigen::VectorXd>& received);

  /// The same as if cells held whatever is taken out of them; the caller sees to what is owed.
  void deliver_all(const std::vector<FilmLayout>& films, double time, double dt,
                   std::vector<Eigen::VectorXd>& received);

  /// Volume due by `time` but not delivered, because more was to be taken out than was there [m3];
  /// negative or 0.
  double undelivered(double time) const;

  /// Sum of all that has been delivered [m3].
  double delivered() const { return delivered_; }
  /// End of the last injection [s].
  double end() const { return end_; }

  /// The first start or end of an injection after `time` [s]; infinity when there is none.
  double next_change(double time) const;

  /// Mutable part, for snapshots: what each injection has delivered.
  std::vector<double> delivered_each() const;
  void get_delivered(std::vector<double>& each) const;
  void restore_delivered(const std::vector<double>& each, double total);

 private:
  /// Volume that should have been delivered by `time` [m3].
  static double due(const PlacedInjection& injection, double time);

  std::vector<PlacedInjection> injections_;
  double delivered_ = 0.0;
  double end_ = 0.0;
};

}  // namespace lipofill::plan
