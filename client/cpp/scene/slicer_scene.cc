#include "client/cpp/scene/slicer_scene.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "client/cpp/io/vtk_messages.h"
#include "client/cpp/json_file.h"
#include "client/cpp/picture/surface.h"

namespace lipofill::client {
namespace {

Surface surface_of(const SkinMotion& motion, const Eigen::Matrix3Xd& points_mm) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(points_mm.cols());
  for (Eigen::Index k = 0; k < points_mm.cols(); ++k) points->SetPoint(k, points_mm.col(k).data());
  vtkNew<vtkCellArray> cells;
  for (const auto& [a, b, c] : motion.triangles) cells->InsertNextCell({a, b, c});
  auto surface = Surface::New();
  surface->SetPoints(points);
  surface->SetPolys(cells);
  // Slicer looks for the frame of a file under this name.
  vtkNew<vtkStringArray> space;
  space->SetName("SPACE");
  space->InsertNextValue("LPS");
  surface->GetFieldData()->AddArray(space);
  return surface;
}

template <typename Values>
void add_scalar(const char* name, const Values& values, vtkPolyData* surface) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  for (const auto value : values) array->InsertNextValue(static_cast<double>(value));
  surface->GetPointData()->AddArray(array);
}

absl::Status write_surface(const std::filesystem::path& file, vtkPolyData* surface) {
  const VtkMessages messages;
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetFileName(file.c_str());
  writer->SetInputData(surface);
  if (writer->Write() != 1 || !messages.error().empty())
    return absl::InvalidArgumentError(absl::StrCat("cannot write ", file.string(), ": ", messages.error()));
  return absl::OkStatus();
}

/// Names of files go into the scene as parts of URLs, in attributes.
std::string escaped(const std::string& name) {
  return absl::StrReplaceAll(
      name, {{"%", "%25"}, {" ", "%20"}, {"&", "%26"}, {"\"", "%22"}, {"<", "%3C"}, {">", "%3E"}, {"#", "%23"}});
}

std::string model_nodes(int number, const std::string& name, const std::string& file, const std::string& display) {
  return absl::StrFormat(
      " <ModelStorage id=\"vtkMRMLModelStorageNode%d\" name=\"%s file\" fileName=\"%s\" coordinateSystem=\"LPS\" />\n"
      " <ModelDisplay id=\"vtkMRMLModelDisplayNode%d\" name=\"%s display\" %s />\n"
      " <Model id=\"vtkMRMLModelNode%d\" name=\"%s\" "
      "references=\"display:vtkMRMLModelDisplayNode%d;storage:vtkMRMLModelStorageNode%d;\" />\n",
      number, name, escaped(file), number, name, display, number, name, number, number);
}

std::string landmark_nodes(const std::string& file) {
  return absl::StrFormat(
      " <MarkupsJsonStorage id=\"vtkMRMLMarkupsJsonStorageNode1\" name=\"landmarks file\" fileName=\"%s\" "
      "coordinateSystem=\"LPS\" />\n"
      " <MarkupsFiducialDisplay id=\"vtkMRMLMarkupsFiducialDisplayNode1\" name=\"landmarks display\" />\n"
      " <MarkupsFiducial id=\"vtkMRMLMarkupsFiducialNode1\" name=\"landmarks\" "
      "references=\"display:vtkMRMLMarkupsFiducialDisplayNode1;storage:vtkMRMLMarkupsJsonStorageNode1;\" />\n",
      escaped(file));
}

}  // namespace

absl::Status write_slicer_scene(const std::filesystem::path& file, const SkinMotion& motion,
                                const std::optional<Landmarks>& landmarks) {
  const std::string stem = file.stem().string();
  const auto beside = [&](const std::string& name) { return file.parent_path() / name; };
  const std::string before = stem + "_before.vtp", planned = stem + "_planned.vtp";
  const std::string points = stem + "_landmarks.mrk.json";
  const Eigen::Matrix3Xf& displacement = motion.stills.back().displacement_mm;
  const Eigen::VectorXf lift = displacement.colwise().norm();

  const Surface rest = surface_of(motion, motion.rest_mm);
  if (auto status = write_surface(beside(before), rest); !status.ok()) return status;
  const Surface moved = surface_of(motion, motion.rest_mm + displacement.cast<double>());
  add_scalar("lift_mm", lift, moved);
  add_scalar(kPressure, motion.pressure_pa, moved);
  if (auto status = write_surface(beside(planned), moved); !status.ok()) return status;

  const std::string colours = absl::StrFormat(
      "color=\"0.87 0.7 0.6\" visibility=\"true\" scalarVisibility=\"true\" activeScalarName=\"lift_mm\" "
      "scalarRangeFlag=\"UseManual\" scalarRange=\"0 %.9g\" "
      "references=\"color:vtkMRMLColorTableNodeFileViridis.txt;\"",
      std::max(lift.maxCoeff(), 1e-6F));
  std::string scene = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<MRML version=\"Slicer5.0.0\" userTags=\"\">\n";
  absl::StrAppend(&scene, model_nodes(1, "before", before, "color=\"0.87 0.7 0.6\" visibility=\"false\""),
                  model_nodes(2, "planned", planned, colours));
  if (landmarks) {
    if (auto status = save_landmarks(*landmarks, beside(points)); !status.ok()) return status;
    absl::StrAppend(&scene, landmark_nodes(points));
  }
  return write_text_file(file, scene + "</MRML>\n");
}

}  // namespace lipofill::client
