#include "client/cli/application.h"

#include <iostream>

#include "absl/strings/str_cat.h"
#include "client/cpp/json_message.h"

namespace lipofill::client {

const Interrupt& Application::interrupt() {
  if (!interrupt_) interrupt_.emplace();
  return *interrupt_;
}

Connection Application::connect() {
  return connect_to(server);
}

Connection Application::connect_to(const std::string& address) {
  return Connection(address, interrupt().token());
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

CLI::App* add_command(CLI::App& parent, Application& application, const std::string& name,
                      const std::string& description, const std::string& examples, Action action) {
  CLI::App* command = add_local_command(parent, application, name, description, examples, std::move(action));
  command
      ->add_option("--server", application.server, "address of the daemon; default $LIPOFILL_SERVER or 127.0.0.1:50061")
      ->type_name("HOST:PORT");
  return command;
}

CLI::App* add_group(CLI::App& parent, const std::string& name, const std::string& description) {
  CLI::App* group = parent.add_subcommand(name, description);
  group->require_subcommand(1);
  return group;
}

}  // namespace lipofill::client
