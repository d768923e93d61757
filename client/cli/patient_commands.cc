#include <map>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/cli/application.h"
#include "client/cli/describe.h"
#include "client/cli/listing.h"
#include "lipofill/v1/patient_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::PatientService;
using Stub = PatientService::Stub;

struct Options {
  std::string name;
  std::string id;
  std::string request_id;
  std::optional<std::string> display_name;
  std::vector<std::string> labels;
  bool force = false;
};

absl::Status set_labels(const std::vector<std::string>& labels, google::protobuf::Map<std::string, std::string>* map) {
  for (const std::string& label : labels) {
    const size_t equals = label.find('=');
    if (equals == std::string::npos)
      return absl::InvalidArgumentError(absl::StrCat("--label ", label, " is not KEY=VALUE"));
    (*map)[label.substr(0, equals)] = label.substr(equals + 1);
  }
  return absl::OkStatus();
}

absl::StatusOr<ExitCode> create(Application& application, const Options& options) {
  v1::CreatePatientRequest request;
  request.set_patient_id(options.id);
  request.set_request_id(options.request_id);
  request.set_display_name(options.display_name.value_or(""));
  if (auto status = set_labels(options.labels, request.mutable_labels()); !status.ok()) return status;
  const auto patient = application.connect().call<PatientService>(&Stub::CreatePatient, request);
  if (!patient.ok()) return patient.status();
  return application.answer(*patient, describe(*patient));
}

absl::StatusOr<v1::Patient> get_patient(const Connection& connection, const std::string& name) {
  v1::GetPatientRequest request;
  request.set_name(full_name("patients", name));
  return connection.call<PatientService>(&Stub::GetPatient, request);
}

absl::StatusOr<ExitCode> get(Application& application, const Options& options) {
  const auto patient = get_patient(application.connect(), options.name);
  if (!patient.ok()) return patient.status();
  return application.answer(*patient, describe(*patient));
}

absl::StatusOr<ExitCode> list(Application& application) {
  const auto all =
      list_all<PatientService>(application.connect(), &Stub::ListPatients, v1::ListPatientsRequest(),
                               [](v1::ListPatientsResponse& response) { return response.mutable_patients(); });
  if (!all.ok()) return all.status();
  std::string text;
  for (const v1::Patient& patient : all->patients()) text += list_line(patient);
  text += unreachable_lines(*all);
  return application.answer(*all, text);
}

/// Leaves everything that is not given as it is: the call itself replaces everything.
absl::StatusOr<ExitCode> update(Application& application, const Options& options) {
  const Connection connection = application.connect();
  auto patient = get_patient(connection, options.name);
  if (!patient.ok()) return patient.status();
  if (options.display_name) patient->set_display_name(*options.display_name);
  if (auto status = set_labels(options.labels, patient->mutable_labels()); !status.ok()) return status;
  v1::UpdatePatientRequest request;
  *request.mutable_patient() = *patient;
  const auto updated = connection.call<PatientService>(&Stub::UpdatePatient, request);
  if (!updated.ok()) return updated.status();
  return application.answer(*updated, describe(*updated));
}

absl::StatusOr<ExitCode> remove(Application& application, const Options& options) {
  v1::DeletePatientRequest request;
  request.set_name(full_name("patients", options.name));
  request.set_force(options.force);
  const auto deleted = application.connect().call<PatientService>(&Stub::DeletePatient, request);
  if (!deleted.ok()) return deleted.status();
  return application.done(absl::StrCat("deleted ", request.name()));
}

void add_name(CLI::App* command, Options& options) {
  command->add_option("patient", options.name, "patients/ID, or the ID alone")->required();
}

void add_contents(CLI::App* command, Options& options) {
  command->add_option("--display-name", options.display_name, "a pseudonym, never a person's name: [a-z0-9-]");
  command->add_option("--label", options.labels, "KEY=VALUE; may be repeated");
}

}  // namespace

void add_patient_commands(CLI::App& root, Application& application) {
  CLI::App* group = add_group(root, "patient", "Patients, by pseudonym");
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_command(*group, application, "create", "Make a patient",
                                  "  lipofill patient create --id case-7 --label side=left\n",
                                  [&application, options] { return create(application, *options); });
  command->add_option("--id", options->id, "the last part of its name: [a-z][a-z0-9-]*; made up when absent");
  command->add_option("--request-id", options->request_id, "a repeated call with the same one gives the same patient");
  add_contents(command, *options);
  add_name(add_command(*group, application, "get", "Show a patient", "  lipofill patient get case-7\n",
                       [&application, options] { return get(application, *options); }),
           *options);
  add_command(*group, application, "list", "List all patients", "  lipofill patient list --json\n",
              [&application] { return list(application); });
  command = add_command(*group, application, "update", "Change display name and labels; what is not given stays",
                        "  lipofill patient update case-7 --label session=2\n",
                        [&application, options] { return update(application, *options); });
  add_name(command, *options);
  add_contents(command, *options);
  command = add_command(*group, application, "delete", "Delete a patient", "  lipofill patient delete case-7 --force\n",
                        [&application, options] { return remove(application, *options); });
  add_name(command, *options);
  command->add_flag("--force", options->force, "its scans and models too");
}

}  // namespace lipofill::client
