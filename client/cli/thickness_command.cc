#include "client/cli/thickness_command.h"

#include <memory>

#include "client/cli/thickness_run.h"

namespace lipofill::client {
namespace {

constexpr char kDescription[] =
    "Measure the thickness of a plan's layers in the volume that its scan came from, under each node of the skin and "
    "along its inward normal. In a CT the innermost layer goes down to bone; in a segmentation (DICOM-SEG, or a label "
    "map as NRRD, NIfTI or MetaImage) every layer whose tissue has a label ends where the next begins. Where the scan "
    "ends, metal is near or nothing is met, the published figure of the layer's kind and region stands, and the model "
    "says at what share. Writes into the folder: plan.json, which lipofill run takes; thickness.json with the spread "
    "and the shares of each layer; thickness.vtp and the map thickness.png. The volume does not leave this machine.";

constexpr char kExamples[] =
    "  lipofill thickness cheek.json ct/ --out measured --spawn\n"
    "  lipofill thickness cheek.json segmentation.nrrd --out measured --spawn --metal ct/\n"
    "  lipofill thickness cheek.json labels.nii.gz --labels skin=1 --labels fat=2 --labels bone=4 --out measured "
    "--spawn\n"
    "  lipofill run measured/plan.json --out result --spawn\n";

}  // namespace

void add_thickness_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<ThicknessOptions>();
  CLI::App* command = add_command(root, application, "thickness", kDescription, kExamples,
                                  [&application, options] { return ThicknessRun(application, *options).carry_out(); });
  add_plan_work_options(*command, *options);
  command
      ->add_option("volume", options->volume,
                   "in the frame of the scan: .mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz or .hdr, or a folder, zip or "
                   "file of DICOM")
      ->required();
  command
      ->add_option("--labels", options->labels,
                   "what a label is: skin, fat, muscle, bone or metal, and its number or name (bone=4); may be "
                   "repeated, and comes before what the names of the labels say")
      ->allow_extra_args(false);
  command->add_option("--series", options->dicom.series, "of DICOM: SeriesNumber or SeriesInstanceUID");
  command->add_option("--metal", options->metal, "a CT that shows metal, for a segmentation that does not");
  command->add_option("--bone-from", options->measuring.bone_from, "values from here on are bone, in a CT HU")
      ->capture_default_str();
  command->add_option("--metal-from", options->measuring.metal_from, "values from here on are metal, in a CT HU")
      ->capture_default_str();
  command->add_option("--metal-reach-mm", options->measuring.metal_reach_mm, "metal spoils what lies nearer")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
}

}  // namespace lipofill::client
