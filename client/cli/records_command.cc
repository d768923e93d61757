#include "client/cli/records_command.h"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/json_file.h"
#include "client/cpp/records/encapsulated.h"
#include "client/cpp/records/fat_segmentation.h"
#include "client/cpp/records/figures_report.h"
#include "client/cpp/records/record.h"
#include "client/cpp/result_text.h"

namespace lipofill::client {
namespace {

struct Options {
  std::string result;
  std::string study;
  std::string series;
  std::string pdf;
  std::string out;
};

constexpr char kDescription[] =
    "Results as DICOM objects of the study that the scan came from: RESULT is a folder of lipofill run or lipofill "
    "export.\n"
    "skin.dcm is the planned skin (encapsulated STL, mm), figures.dcm a structured report of volumes, zones, pressures "
    "and distances with their units (Comprehensive SR, unverified), fat.dcm the planned fat on the voxels of the "
    "series (segmentation) where the study has one, and report.dcm the PDF given by --pdf.\n"
    "Patient and study are copied from the study's own headers and go into these files alone. UIDs follow from the "
    "content: the same result makes the same objects, so sending them twice changes nothing. The plan must have been "
    "made on the skin of that series, in LPS, as lipofill scan extract writes it.";

/// A record that was written, or why it was not.
struct Written {
  std::string file;
  std::string sop_instance_uid;
  std::string remark;
};

class RecordWriter {
 public:
  RecordWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

  absl::Status write(const std::string& name, DcmDataset* record, const std::string& remark = "") {
    const std::filesystem::path file = folder_ / name;
    if (auto status = write_record(file, record); !status.ok()) return status;
    OFString uid;
    record->findAndGetOFString(DCM_SOPInstanceUID, uid);
    written_.push_back({file.string(), uid.c_str(), remark});
    return absl::OkStatus();
  }

  const std::vector<Written>& written() const { return written_; }

 private:
  std::filesystem::path folder_;
  std::vector<Written> written_;
};

absl::Status write_report(const RecordStudy& study, const FinishedPlan& plan, const std::string& pdf,
                          RecordWriter* writer) {
  if (pdf.empty()) return absl::OkStatus();
  const auto bytes = read_text_file(pdf);
  if (!bytes.ok()) return bytes.status();
  const auto record = make_report_record(study, plan, *bytes);
  if (!record.ok()) return absl::InvalidArgumentError(absl::StrCat(pdf, " ", record.status().message()));
  return writer->write("report.dcm", record->get());
}

/// The fat, where it can be drawn; `left_out` says why it cannot.
absl::Status write_fat(const RecordStudy& study, const FinishedPlan& plan, RecordWriter* writer,
                       std::string* left_out) {
  const auto fat = make_fat_record(study, plan);
  if (absl::IsFailedPrecondition(fat.status())) {
    *left_out = std::string(fat.status().message());
    return absl::OkStatus();
  }
  if (!fat.ok()) return fat.status();
  return writer->write(
      "fat.dcm", fat->record.get(),
      absl::StrFormat("%.2f mL of fat as %.2f mL of voxels in %d slices", fat->film_ml, fat->voxels_ml, fat->frames));
}

void print(const Application& application, const RecordWriter& writer, const std::string& left_out) {
  if (application.json) {
    nlohmann::ordered_json files = nlohmann::ordered_json::array();
    for (const Written& each : writer.written())
      files.push_back({{"file", each.file}, {"sop_instance_uid", each.sop_instance_uid}, {"remark", each.remark}});
    std::cout << nlohmann::ordered_json{{"files", files}, {"no_fat_because", left_out}}.dump(2) << "\n";
    return;
  }
  for (const Written& each : writer.written())
    std::cout << each.file << (each.remark.empty() ? "" : ": ") << each.remark << "\n";
  if (!left_out.empty()) std::cout << "no fat.dcm: " << left_out << "\n";
  std::cout << kNotAMedicalDevice << "\n";
}

absl::StatusOr<ExitCode> make(const Application& application, const Options& options) {
  const auto plan = read_finished_plan(options.result);
  if (!plan.ok()) return plan.status();
  const auto study = read_record_study(options.study, options.series);
  if (!study.ok()) return study.status();
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error)
    return absl::InvalidArgumentError(absl::StrCat("cannot make the folder ", options.out, ": ", error.message()));
  RecordWriter writer(options.out);
  const auto figures = make_figures_record(*study, *plan);
  if (!figures.ok()) return figures.status();
  std::string left_out;
  absl::Status status = write_report(*study, *plan, options.pdf, &writer);
  if (status.ok()) status = writer.write("skin.dcm", make_skin_record(*study, *plan).get());
  if (status.ok()) status = writer.write("figures.dcm", figures->get());
  if (status.ok()) status = write_fat(*study, *plan, &writer, &left_out);
  if (!status.ok()) return status;
  print(application, writer, left_out);
  return ExitCode::kOk;
}

}  // namespace

void add_records_commands(CLI::App& root, Application& application) {
  CLI::App* group = add_group(root, "records", "Results as DICOM, and the way to a PACS and from it");
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      add_local_command(*group, application, "make", kDescription,
                        "  lipofill records make result --study ct/ --out records\n"
                        "  lipofill records make result --study study.zip --series 4 --pdf report.pdf --out records\n"
                        "  lipofill records send --pacs ORTHANC@localhost:4242 records/*.dcm\n",
                        [&application, options] { return make(application, *options); });
  command->add_option("result", options->result, "folder of a plan that has SETTLED or FINISHED")->required();
  command->add_option("--study", options->study, "folder, zip or file of DICOM: the study the scan came from")
      ->required();
  command->add_option("--series", options->series,
                      "number or UID of the series the skin is from; default: the largest axial CT");
  command->add_option("--pdf", options->pdf, "a report to put beside it")->type_name("FILE.pdf");
  command->add_option("--out", options->out, "folder for the files")->required();
  add_pacs_commands(*group, application);
}

}  // namespace lipofill::client
