#pragma once

#include <CLI/CLI.hpp>

namespace lipofill::client {

/// Takes one of the names of a map for what it stands for. The help of the option says the names;
/// CLI11's own description would list the numbers of the enumeration beside them.
template <typename Names>
CLI::Validator choice_of(const Names& names) {
  return CLI::CheckedTransformer(names).description("");
}

}  // namespace lipofill::client
