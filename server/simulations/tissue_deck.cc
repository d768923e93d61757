#include "server/simulations/tissue_deck.h"

#include <cstring>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/export/calculix_deck.h"
#include "server/backend/result_reading.h"
#include "server/entry/unary.h"
#include "server/store/record_names.h"
#include "server/wire/names.h"
#include "server/wire/simulation_conversion.h"

namespace lipofill::server {
namespace {

using exporting::CalculixDeck;

constexpr size_t kMaxPieceBytes = size_t{1} << 20;

struct TimedDeck {
  CalculixDeck deck;
  double time_s = 0.0;
};

/// Sends a deck piece by piece, each made once the one before is on its way.
class DeckStream : public grpc::ServerWriteReactor<v1::ExportTissueDeckResponse> {
 public:
  explicit DeckStream(grpc::CallbackServerContext* context) : context_(context) {}

  void send(TimedDeck deck) {
    if (const absl::Status room = keep_answers(context_, deck.deck.memory_bytes()); !room.ok()) return fail(room);
    deck_.emplace(std::move(deck));
    send_next();
  }
  void fail(const absl::Status& status) { Finish(to_grpc_status(status)); }

  void OnWriteDone(bool ok) override {
    if (!ok) return fail(absl::CancelledError("the client has gone"));
    if (const absl::Status known = check_still_known(context_); !known.ok()) return fail(known);
    send_next();
  }
  void OnDone() override { delete this; }

 private:
  void send_next() {
    const absl::Status made = guarded([this] {
      piece_.set_time_s(deck_->time_s);
      piece_.set_data(deck_->deck.read(kMaxPieceBytes));
      return absl::OkStatus();
    });
    if (!made.ok()) return fail(made);
    if (piece_.data().empty()) return Finish(grpc::Status::OK);
    StartWrite(&piece_);
  }

  grpc::CallbackServerContext* const context_;
  std::optional<TimedDeck> deck_;
  v1::ExportTissueDeckResponse piece_;
};

absl::StatusOr<Eigen::VectorXd> find_pressure(const v1::FrameSlice& frame, const std::string& film) {
  const std::string name = absl::StrCat("film/", film, ".pressure");
  for (const v1::ArraySlice& array : frame.fields()) {
    if (array.name() != name) continue;
    Eigen::VectorXf values(static_cast<Eigen::Index>(array.data().size() / sizeof(float)));
    std::memcpy(values.data(), array.data().data(), static_cast<size_t>(values.size()) * sizeof(float));
    return values.cast<double>();
  }
  return absl::DataLossError(absl::StrCat("the result has no array ", name));
}

absl::StatusOr<TimedDeck> make_deck(Backend& backend, const std::string& id, const Unwanted& unwanted) {
  const auto record = backend.store.get_simulation(id);
  if (!record.ok()) return record.status();
  v1::SimulationSpec message;
  if (!message.ParseFromString(record->spec_message)) return absl::DataLossError("the plan cannot be read");
  const auto spec = to_simulation_spec(message);
  if (!spec.ok()) return spec.status();
  const auto model = backend.load_model(record->model);
  if (absl::IsNotFound(model.status())) {
    return absl::FailedPreconditionError(
        absl::StrCat(simulation_name(id), " has outlived its model: ", record->model, " was deleted"));
  }
  if (!model.ok()) return model.status();
  if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
  std::vector<std::string> films;
  for (const plan::FilmSpec& film : spec->films) films.push_back("film/" + film.name);
  const auto present = read_present(backend, id, films);
  if (!present.ok()) return present.status();
  std::vector<Eigen::VectorXd> pressures;
  for (const plan::FilmSpec& film : spec->films) {
    auto pressure = find_pressure(present->frame, film.name);
    if (!pressure.ok()) return pressure.status();
    pressures.push_back(*std::move(pressure));
  }
  if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
  auto deck = CalculixDeck::create(**model, *spec, pressures);
  if (!deck.ok()) return deck.status();
  return TimedDeck{*std::move(deck), present->frame.time_s()};
}

}  // namespace

grpc::ServerWriteReactor<v1::ExportTissueDeckResponse>* export_tissue_deck(Backend& backend,
                                                                           grpc::CallbackServerContext* context,
                                                                           const v1::ExportTissueDeckRequest& request) {
  auto* stream = new DeckStream(context);
  absl::Status valid = check_call(context, request);
  const auto id = parse_simulation_name(request.name(), "name");
  valid.Update(id.status());
  if (!valid.ok()) {
    stream->fail(valid);
    return stream;
  }
  const bool taken = backend.calls.run([&backend, context, stream, id = *id] {
    std::optional<TimedDeck> deck;
    const Unwanted unwanted = caller_has_left(context);
    const absl::Status made = guarded_if_wanted(unwanted, [&]() -> absl::Status {
      auto ready = make_deck(backend, id, unwanted);
      if (ready.ok()) deck.emplace(*std::move(ready));
      return ready.status();
    });
    if (made.ok()) {
      stream->send(*std::move(deck));
    } else {
      stream->fail(made);
    }
  });
  if (!taken) stream->fail(too_many_calls(backend));
  return stream;
}

}  // namespace lipofill::server
