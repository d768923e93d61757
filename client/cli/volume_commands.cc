#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/application.h"
#include "client/cpp/dicom/any_volume.h"
#include "client/cpp/dicom/dicom_choice.h"
#include "client/cpp/dicom/dicom_volume.h"
#include "client/cpp/volume/skin_extraction.h"

namespace lipofill::client {
namespace {

struct Options {
  std::string volume;
  std::string out;
  SkinExtraction extraction;
  DicomReading dicom;
};

constexpr char kExtractDescription[] =
    "The skin in a CT or MRI volume: the surface at a value, as triangles in millimetres.\n"
    "Reads MetaImage (.mha, .mhd), NRRD (.nrrd, .nhdr) and NIfTI-1 and -2 (.nii, .nii.gz, .hdr with .img) with their "
    "orientation and units; and DICOM series of CT, CBCT and MR: a folder, a zip or a file of several frames, of which "
    "the largest axial CT is taken unless --series names another (lipofill scan series lists them); and segmentations: "
    "DICOM-SEG, and label maps in the other formats, with the names that 3D Slicer gives to labels. The surface is in "
    "the "
    "patient's LPS axes: x to the left, y to the back, z up (NIfTI's and NRRD's RAS are turned to LPS); a NRRD without "
    "a space or a NIfTI "
    "without qform and sform stays in its own axes, which the answer says. Axes for a landmarks file in LPS: left "
    "[1,0,0], "
    "up [0,0,1], forward [0,-1,0].\n"
    "In a head CT the skin at -300 HU opens into the airways and sinuses; the largest connected piece, which is taken, "
    "has their "
    "walls too. The model builder takes what is seen from outside.\n"
    "The bone is extracted the same way, at +250 HU, with --all: jaw and skull are separate pieces. As a plan's bone "
    "it "
    "says how deep the tissue is.";

constexpr char kSeriesDescription[] =
    "The DICOM series in a folder, a zip or a file, with their size and spacing.\n"
    "The number or the UID of a series goes to `lipofill scan extract --series`. A series that is no volume says why: "
    "slices that are missing, mixed orientations, a gantry that leans and the like are found here. What the headers "
    "say "
    "of the patient is not shown, but a description may hold whatever the scanner's operator wrote.";

nlohmann::ordered_json describe_series(const DicomSeries& series) {
  nlohmann::ordered_json answer = {{"number", series.number},
                                   {"uid", series.uid},
                                   {"modality", series.modality},
                                   {"description", series.description},
                                   {"images", series.images}};
  if (!series.problem.empty()) {
    answer["problem"] = series.problem;
    return answer;
  }
  const DicomFrame& first = series.stack.slices.front();
  answer["size"] = {first.columns, first.rows, series.stack.slices.size()};
  answer["spacing_mm"] = {first.spacing[0], first.spacing[1], series.stack.slice_spacing};
  answer["orientation"] = series.stack.orientation;
  answer["remarks"] = series.stack.remarks;
  return answer;
}

void print_series(const DicomSeries& series) {
  std::cout << absl::StrFormat("%s  %s\n  UID %s\n", series.label(), series.description, series.uid);
  if (!series.problem.empty()) {
    std::cout << "  no volume: " << series.problem << "\n";
    return;
  }
  const auto& spacing = series.stack.slices.front().spacing;
  std::cout << absl::StrFormat("  %s, voxels of %.4g x %.4g x %.4g mm\n", series.stack.orientation, spacing[0],
                               spacing[1], series.stack.slice_spacing);
  for (const std::string& remark : series.stack.remarks) std::cout << "  remark: " << remark << "\n";
}

absl::StatusOr<ExitCode> list_dicom_series(const Application& application, const Options& options) {
  const auto listing = list_dicom(options.volume);
  if (!listing.ok()) return listing.status();
  if (auto status = check_has_images(options.volume, *listing); !status.ok()) return status;
  if (application.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const DicomSeries& series : listing->series) all.push_back(describe_series(series));
    std::cout << nlohmann::ordered_json{{"series", all},
                                        {"patients", listing->patients},
                                        {"files_without_image", listing->without_image},
                                        {"other_files", listing->other_files},
                                        {"unreadable_files", listing->unreadable_files}}
                     .dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
    return ExitCode::kOk;
  }
  for (const DicomSeries& series : listing->series) print_series(series);
  std::cout << absl::StrFormat(
      "series: %d, patients: %d; files without an image: %d, of other kinds: %d, cut short: %d\n",
      listing->series.size(), listing->patients, listing->without_image, listing->other_files,
      listing->unreadable_files);
  return ExitCode::kOk;
}

/// Extracts from a volume file or, where that is what it is, from DICOM.
absl::StatusOr<ExtractedSkin> extract_from(const Options& options) {
  if (auto status = check_surface_name(options.out); !status.ok()) return status;
  auto volume = read_any_volume(options.volume, options.dicom);
  if (!volume.ok()) return volume.status();
  return extract_skin(*std::move(volume), options.volume, options.out, options.extraction);
}

absl::StatusOr<ExitCode> extract(const Application& application, const Options& options) {
  const auto skin = extract_from(options);
  if (!skin.ok()) return skin.status();
  const auto& b = skin->bounds_mm;
  if (application.json) {
    const nlohmann::ordered_json answer = {{"file", options.out},
                                           {"vertices", skin->vertices},
                                           {"triangles", skin->triangles},
                                           {"components", skin->components},
                                           {"bounds_mm", b},
                                           {"frame", skin->frame},
                                           {"isovalue", options.extraction.isovalue},
                                           {"remarks", skin->remarks}};
    std::cout << answer.dump(2) << "\n";
  } else {
    std::cout << absl::StrFormat(
        "%s: %d vertices, %d triangles, from %d connected pieces at the value %g\n  x %.1f to %.1f, y %.1f to %.1f, z "
        "%.1f to %.1f "
        "mm; axes: %s\n",
        options.out, skin->vertices, skin->triangles, skin->components, options.extraction.isovalue, b[0], b[1], b[2],
        b[3], b[4], b[5], skin->frame == "LPS" ? "LPS (x to the left, y to the back, z up)" : skin->frame);
    for (const std::string& remark : skin->remarks) std::cout << "  remark: " << remark << "\n";
  }
  return ExitCode::kOk;
}

}  // namespace

void add_volume_commands(CLI::App& scan, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      add_local_command(scan, application, "extract", kExtractDescription,
                        "  lipofill scan extract head.mha --isovalue -300 --out skin.ply\n"
                        "  lipofill scan extract head.mha --isovalue 250 --all --out bone.ply\n"
                        "  lipofill scan extract head.nii.gz --out skin.stl --smooth 20 --triangles 200000\n"
                        "  lipofill scan extract segmentation.nrrd --label 2 --smooth 30 --all --out bone.ply\n"
                        "  lipofill scan extract segmentation.dcm --label bone --smooth 30 --all --out bone.ply\n"
                        "  lipofill scan extract dicom/ --series 3 --out skin.ply\n"
                        "  lipofill scan extract study.zip --out skin.ply\n",
                        [&application, options] { return extract(application, *options); });
  command
      ->add_option("volume", options->volume,
                   ".mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz or .hdr, or a folder, zip or file of DICOM")
      ->required();
  command->add_option("--out", options->out, ".obj, .ply or .stl")->required();
  command
      ->add_option("--isovalue", options->extraction.isovalue,
                   "in the volume's values; -300 (the default) is the skin in HU, 250 the bone")
      ->capture_default_str();
  command
      ->add_option("--label", options->extraction.labels,
                   "of a label map: the surface around voxels with this number or name, or of a tissue (skin, fat, "
                   "muscle, bone, metal), or around all; may be repeated; --smooth takes its steps away")
      ->allow_extra_args(false);
  command->add_flag("--all", options->extraction.all_components,
                    "take every piece, not only the largest connected one");
  command
      ->add_option("--smooth", options->extraction.smoothing_iterations,
                   "iterations of windowed-sinc smoothing; the volume stays as it is")
      ->check(CLI::Range(0, 1000));
  command->add_option("--triangles", options->extraction.target_triangles, "thin out to about as many triangles")
      ->check(CLI::Range(uint64_t{100}, uint64_t{100'000'000}));
  command->add_option("--series", options->dicom.series,
                      "of DICOM: SeriesNumber or SeriesInstanceUID; otherwise the largest axial CT");
  command->add_flag("--bridge-gaps", options->dicom.bridge_gaps,
                    "of DICOM: cross places where slices are missing in a straight line");
  add_local_command(scan, application, "series", kSeriesDescription,
                    "  lipofill scan series dicom/\n  lipofill scan series study.zip --json\n",
                    [&application, options] { return list_dicom_series(application, *options); })
      ->add_option("source", options->volume, "a folder, a zip or a file of DICOM")
      ->required();
}

}  // namespace lipofill::client
