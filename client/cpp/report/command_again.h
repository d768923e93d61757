#pragma once

#include <string>
#include <vector>

namespace lipofill::client {

/// The line that makes a report again, from the words of the one that made it: elsewhere too, files
/// by their names alone, the date said, without what only concerns the place of the first. Quoted
/// as a shell needs it. Checked by tests/unit/client/report_record_test.cc.
/// @param words  of the command line after the program's name
std::string command_again(const std::vector<std::string>& words, const std::string& date);

}  // namespace lipofill::client
