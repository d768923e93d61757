#include "client/cli/deliver_run.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "client/cli/changed_plan.h"
#include "client/cpp/json_file.h"
#include "client/cpp/json_message.h"
#include "lipofill/v1/planning_service.grpc.pb.h"

namespace lipofill::client {
namespace {

/// Names of zones are the plan's own, and may have anything in them.
std::string quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string place_text(const v1::Vector3& place) {
  return absl::StrFormat("%.2f,%.2f,%.2f", place.x(), place.y(), place.z());
}

/// A pass a line, in the order in which they are made.
std::string passes_csv(const v1::Delivery& delivery) {
  std::string text =
      "pass,zone,below_layer,entry,tunnel,volume_ml,entry_x_mm,entry_y_mm,entry_z_mm,far_x_mm,far_y_mm,far_z_mm\n";
  for (int k = 0; k < delivery.passes_size(); ++k) {
    const v1::CannulaPass& pass = delivery.passes(k);
    const v1::CannulaEntry& entry = delivery.entries(static_cast<int>(pass.entry()));
    const v1::Vector3& far = pass.path_mm_size() > 0 ? pass.path_mm(0) : entry.place_mm();
    absl::StrAppendFormat(&text, "%d,%s,%s,%d,%d,%.4f,%s,%s\n", k + 1, quoted(entry.zone()),
                          quoted(entry.below_layer()), pass.entry() + 1, pass.tunnel() + 1, pass.volume_ml(),
                          place_text(entry.place_mm()), place_text(far));
  }
  return text;
}

std::string describe(const v1::Delivery& delivery) {
  double total = 0.0;
  std::string text;
  for (int k = 0; k < delivery.entries_size(); ++k) {
    const v1::CannulaEntry& entry = delivery.entries(k);
    uint32_t tunnels = 0;
    double most = 0.0;
    for (const v1::CannulaPass& pass : delivery.passes()) {
      if (pass.entry() != static_cast<uint32_t>(k)) continue;
      tunnels = std::max(tunnels, pass.tunnel() + 1);
      most = std::max(most, pass.volume_ml());
    }
    absl::StrAppendFormat(&text,
                          "entry %d at (%s) mm: zone %s, below %s\n  %.3f mL in %d passes of at most %.3f mL along %d "
                          "tunnels\n",
                          k + 1, place_text(entry.place_mm()), entry.zone(), entry.below_layer(), entry.volume_ml(),
                          entry.passes(), most, tunnels);
    total += entry.volume_ml();
  }
  absl::StrAppendFormat(&text, "%.3f mL in %d passes\n", total, delivery.passes_size());
  if (delivery.has_difference()) {
    absl::StrAppendFormat(&text, "the skin differs from that of the plan by %.2f mm rms, %.2f mm at most\n",
                          delivery.difference().rms_mm(), delivery.difference().max_mm());
  }
  for (const std::string& remark : delivery.remarks()) absl::StrAppend(&text, "remark: ", remark, "\n");
  return text;
}

}  // namespace

DeliverRun::DeliverRun(Application& application, DeliverOptions options)
    : PlanWork(application, options), options_(std::move(options)) {}

absl::Status DeliverRun::work() {
  v1::PlanDeliveryRequest request;
  *request.mutable_plan() = ground_.plan().plan.simulation();
  request.mutable_plan()->set_model(ground_.model().name());
  if (options_.max_pass_ml) request.set_max_pass_ml(*options_.max_pass_ml);
  if (options_.tunnel_spacing_mm) request.set_tunnel_spacing_mm(*options_.tunnel_spacing_mm);
  request.set_compare(options_.compare);
  progress_.show(options_.compare ? "finding both settled shapes" : "listing the passes");
  auto delivery = ground_.connection().call<v1::PlanningService>(&v1::PlanningService::Stub::PlanDelivery, request);
  if (!delivery.ok()) return delivery.status();
  delivery_ = *std::move(delivery);
  return absl::OkStatus();
}

absl::Status DeliverRun::write_results() const {
  const std::filesystem::path folder = options_.out;
  const v1::Plan plan = plan_file_of(ground_.plan(), ground_.model(), delivery_.plan_as_given(), folder);
  absl::Status written = write_text_file(folder / "plan.json", compact_message_json(plan));
  if (written.ok()) written = write_text_file(folder / "passes.csv", passes_csv(delivery_));
  if (written.ok()) written = write_text_file(folder / "delivery.json", message_json(delivery_));
  return written;
}

std::string DeliverRun::json() const {
  return message_json(delivery_);
}

std::string DeliverRun::text() const {
  return absl::StrCat(describe(delivery_), "passes.csv, delivery.json and plan.json in ", options_.out, "\n");
}

std::string DeliverRun::option_of(const std::string& field) const {
  if (absl::StartsWith(field, "plan.")) return absl::StrCat("simulation.", absl::StripPrefix(field, "plan."));
  const bool is_option = field == "max_pass_ml" || field == "tunnel_spacing_mm";
  return is_option ? absl::StrCat("--", absl::StrReplaceAll(field, {{"_", "-"}})) : field;
}

}  // namespace lipofill::client
