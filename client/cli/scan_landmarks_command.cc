#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/options.h"
#include "client/cli/scan_check.h"
#include "client/cli/units.h"
#include "client/cpp/landmarks_file.h"

namespace lipofill::client {
namespace {

constexpr char kDescription[] =
    "Read a file of landmarks, show by what names and where the daemon will have them, in mm, and write them for "
    "another program. Files: the project's own .json, markups and fiducials of 3D Slicer (.mrk.json, .fcsv; RAS is "
    "turned to LPS), points picked in MeshLab (.pp), and tables of name, x, y, z (.csv, .tsv, .txt). Names of common "
    "schemes are understood: go_l, exR, left zygion, prn, sn, pg, me. Left and right are the subject's own.";

constexpr char kExamples[] =
    "  lipofill scan landmarks face.mrk.json\n"
    "  lipofill scan landmarks face.fcsv --out face.json\n"
    "  lipofill scan landmarks face.json --out face.mrk.json      for 3D Slicer\n"
    "  lipofill scan landmarks picked.pp --unit m --out face.csv\n";

struct Options {
  std::string file;
  std::string out;
  v1::ScanUnit unit = v1::MILLIMETRE;
};

std::string to_text(const Landmarks& landmarks) {
  std::string text;
  for (const auto& [name, at] : landmarks.points_mm) {
    absl::StrAppendFormat(&text, "  %-20s %10.3f %10.3f %10.3f mm\n", name, at[0], at[1], at[2]);
  }
  for (const std::string& remark : landmarks.remarks) absl::StrAppend(&text, "  ", remark, "\n");
  return text;
}

absl::StatusOr<ExitCode> show(const Application& application, const Options& options) {
  const auto landmarks = load_landmarks(options.file, options.unit);
  if (!landmarks.ok()) return landmarks.status();
  if (!options.out.empty()) {
    if (auto saved = save_landmarks(*landmarks, options.out); !saved.ok()) return saved;
  }
  if (application.json) {
    const nlohmann::ordered_json document = {
        {"file", options.file}, {"landmarks_mm", landmarks->points_mm}, {"remarks", landmarks->remarks}};
    std::cout << document.dump(2) << "\n";
    return ExitCode::kOk;
  }
  std::cout << options.file << "\n" << to_text(*landmarks);
  if (!options.out.empty()) std::cout << "  wrote " << options.out << "\n";
  return ExitCode::kOk;
}

}  // namespace

void add_scan_landmarks_command(CLI::App& scan, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_local_command(scan, application, "landmarks", kDescription, kExamples,
                                        [&application, options] { return show(application, *options); });
  command->add_option("file", options->file, "the landmarks; FILE.json#OBJECT names an object in a .json")->required();
  command
      ->add_option("--unit", options->unit, "unit of the numbers, where the file does not tell: mm (default), cm or m")
      ->transform(choice_of(kUnitNames));
  command->add_option("--out", options->out, "write them, in mm and LPS, as .json, .mrk.json, .fcsv, .pp or .csv");
}

}  // namespace lipofill::client
