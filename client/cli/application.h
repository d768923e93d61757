#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cli/exit_codes.h"
#include "client/cli/interrupt.h"
#include "client/cpp/connection.h"
#include "google/protobuf/message.h"

namespace lipofill::client {

using Action = std::function<absl::StatusOr<ExitCode>()>;

/// The part that all commands share: the options every one has, the connection, the ways to answer.
class Application {
 public:
  std::string server = default_server();
  CredentialFiles credential_files = credential_files_of_environment();
  bool json = false;
  std::vector<std::string> words;  ///< of the command line, after the program's name
  Action action;                   ///< what the command line asks for

  /// Makes Ctrl-C ask to stop, from here on, instead of ending the program.
  const Interrupt& interrupt();
  /// Reads the files of credentials; to be called before anything connects.
  absl::Status read_credentials();
  Connection connect();
  /// Connects to `server` with the credentials, and to any other, private daemon without.
  Connection connect_to(const std::string& address);

  /// Answers with a message: its JSON with --json, else the text.
  ExitCode answer(const google::protobuf::Message& message, const std::string& text) const;
  /// The same where there is nothing to tell but that it is done.
  ExitCode done(const std::string& text) const;

 private:
  std::optional<Interrupt> interrupt_;
  Credentials credentials_;
};

/// A command with --server and --json that carries out `action` once the command line is read.
CLI::App* add_command(CLI::App& parent, Application& application, const std::string& name,
                      const std::string& description, const std::string& examples, Action action);

/// A command that does its work without a daemon: --json only.
CLI::App* add_local_command(CLI::App& parent, Application& application, const std::string& name,
                            const std::string& description, const std::string& examples, Action action);

/// The options that say which daemon a command speaks to, and as whom; add_command() adds them by
/// itself. A command that connects only sometimes reads the credentials when it does.
void add_connection_options(CLI::App& command, Application& application);

/// A word that only holds further commands.
CLI::App* add_group(CLI::App& parent, const std::string& name, const std::string& description);

// Each of these adds one part of the command line.
void add_run_command(CLI::App& root, Application& application);
void add_plan_commands(CLI::App& root, Application& application);
void add_patient_commands(CLI::App& root, Application& application);
void add_scan_commands(CLI::App& root, Application& application);
void add_volume_commands(CLI::App& scan, Application& application);
void add_model_commands(CLI::App& root, Application& application);
/// These are added below the group of the plans.
void add_saved_plan_commands(CLI::App& group, Application& application);
/// These are added below the group of the simulations.
void add_checkpoint_commands(CLI::App& group, Application& application);
void add_simulation_commands(CLI::App& root, Application& application);
void add_watch_command(CLI::App& root, Application& application);
void add_export_command(CLI::App& root, Application& application);
void add_evaluate_command(CLI::App& root, Application& application);
void add_propose_command(CLI::App& root, Application& application);
void add_deliver_command(CLI::App& root, Application& application);
void add_shape_command(CLI::App& root, Application& application);
void add_target_command(CLI::App& root, Application& application);
void add_operation_commands(CLI::App& root, Application& application);
void add_health_command(CLI::App& root, Application& application);
void add_render_command(CLI::App& root, Application& application);
void add_report_command(CLI::App& root, Application& application);

}  // namespace lipofill::client
