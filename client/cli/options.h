#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace lipofill::client {

/// Takes one of the names of a map for what it stands for. The help of the option says the names;
/// CLI11's own description would list the numbers of the enumeration beside them.
template <typename Names>
CLI::Validator choice_of(const Names& names) {
  return CLI::CheckedTransformer(names).description("");
}

/// An option that sets a field of a message where it is given.
template <typename Value, typename Set>
CLI::Option* add_field(CLI::App& command, const std::string& name, const std::string& help, Set set) {
  return command.add_option_function<Value>(
      name, [set](const Value& value) { set(value); }, help);
}

}  // namespace lipofill::client
