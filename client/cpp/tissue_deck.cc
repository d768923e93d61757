#include "client/cpp/tissue_deck.h"

#include <fstream>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {
namespace {

absl::Status cannot_write(const std::filesystem::path& file) {
  return absl::InvalidArgumentError(absl::StrCat("cannot write ", file.string()));
}

absl::StatusOr<TissueDeckFile> receive(const Connection& connection, const std::string& simulation,
                                       const std::filesystem::path& file, const DeckProgress& progress) {
  std::ofstream out(file, std::ios::binary);
  if (!out) return cannot_write(file);
  const auto stub = v1::SimulationService::NewStub(connection.channel());
  grpc::ClientContext context;
  std::stop_callback cancel(connection.stop(), [&context] { context.TryCancel(); });
  v1::ExportTissueDeckRequest request;
  request.set_name(simulation);
  const auto reader = stub->ExportTissueDeck(&context, request);
  TissueDeckFile deck;
  v1::ExportTissueDeckResponse piece;
  while (out && reader->Read(&piece)) {
    out.write(piece.data().data(), static_cast<std::streamsize>(piece.data().size()));
    deck.bytes += piece.data().size();
    deck.time_s = piece.time_s();
    if (progress) progress(deck.bytes);
  }
  out.close();
  if (!out) context.TryCancel();
  const absl::Status status = status_of(reader->Finish(), connection.server());
  if (!out) return cannot_write(file);
  if (!status.ok()) return status;
  return deck;
}

}  // namespace

absl::StatusOr<TissueDeckFile> download_tissue_deck(const Connection& connection, const std::string& simulation,
                                                    const std::filesystem::path& file, const DeckProgress& progress) {
  std::filesystem::path part = file;
  part += ".part";
  auto deck = receive(connection, simulation, part, progress);
  std::error_code error;
  if (deck.ok()) std::filesystem::rename(part, file, error);
  if (error) deck = absl::InvalidArgumentError(absl::StrCat("cannot write ", file.string(), ": ", error.message()));
  std::error_code ignored;
  if (!deck.ok()) std::filesystem::remove(part, ignored);
  return deck;
}

}  // namespace lipofill::client
