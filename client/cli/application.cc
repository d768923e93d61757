#include "client/cli/application.h"

#include <iostream>

#include "absl/strings/str_cat.h"
#include "client/cpp/credentials.h"
#include "client/cpp/json_message.h"

namespace lipofill::client {

const Interrupt& Application::interrupt() {
  if (!interrupt_) interrupt_.emplace();
  return *interrupt_;
}

absl::Status Application::read_credentials() {
  auto credentials = client::read_credentials(credential_files, server);
  if (credentials.ok()) credentials_ = *std::move(credentials);
  return credentials.status();
}

Connection Application::connect() {
  return connect_to(server);
}

Connection Application::connect_to(const std::string& address) {
  return Connection(address, interrupt().token(), address == server ? credentials_ : Credentials{});
}

ExitCode Application::answer(const google::protobuf::Message& message, const std::string& text) const {
  std::cout << (json ? message_json(message) : text) << std::flush;
  return ExitCode::kOk;
}

ExitCode Application::done(const std::string& text) const {
  std::cout << (json ? "{}\n" : absl::StrCat(text, "\n")) << std::flush;
  return ExitCode::kOk;
}

CLI::App* add_local_command(CLI::App& parent, Application& application, const std::string& name,
                            const std::string& description, const std::string& examples, Action action) {
  CLI::App* command = parent.add_subcommand(name, description);
  command->add_flag("--json", application.json, "answer with JSON, errors too (on the error output)");
  command->footer(absl::StrCat("Examples:\n", examples, "\n", kExitCodeHelp));
  command->callback([&application, action = std::move(action)] { application.action = action; });
  return command;
}

void add_connection_options(CLI::App& command, Application& application) {
  command
      .add_option("--server", application.server, "address of the daemon; default $LIPOFILL_SERVER or 127.0.0.1:50061")
      ->type_name("HOST:PORT");
  const auto add_file = [&](const char* flag, std::string& file, const char* help) {
    command.add_option(flag, file, help)->type_name("PATH");
  };
  CredentialFiles& files = application.credential_files;
  add_file("--token-file", files.token, "file with the token that says who calls; default $LIPOFILL_TOKEN_FILE");
  add_file("--tls-ca", files.tls_ca, "authorities of the daemon's certificate, for TLS; default $LIPOFILL_TLS_CA");
  add_file("--tls-cert", files.tls_cert, "client certificate; default $LIPOFILL_TLS_CERT");
  add_file("--tls-key", files.tls_key, "its private key; default $LIPOFILL_TLS_KEY");
}

CLI::App* add_command(CLI::App& parent, Application& application, const std::string& name,
                      const std::string& description, const std::string& examples, Action action) {
  CLI::App* command = add_local_command(parent, application, name, description, examples,
                                        [&application, action = std::move(action)]() -> absl::StatusOr<ExitCode> {
                                          if (auto read = application.read_credentials(); !read.ok()) return read;
                                          return action();
                                        });
  add_connection_options(*command, application);
  return command;
}

CLI::App* add_group(CLI::App& parent, const std::string& name, const std::string& description) {
  CLI::App* group = parent.add_subcommand(name, description);
  group->require_subcommand(1);
  return group;
}

}  // namespace lipofill::client
